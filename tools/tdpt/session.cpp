#include "tools/tdpt/session.h"

#include <csignal>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <poll.h>

#include <nlohmann/json.hpp>
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/process.h"

namespace tdpt {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr auto kEvery = std::chrono::milliseconds(300);
constexpr const char* kDecision = ", because ";  // in sentences of --explain
constexpr int kNice = 10;                        // of a first preview: the stages have priority

// `progress`: an object from a program [base/progress.h].
std::string words_of(const Json& progress) {
  const auto number = [&](const char* key) {
    return progress.contains(key) && progress[key].is_number() ? progress[key].get<double>() : -1;
  };
  const double total = number("total"), done = number("done"), left = number("left");
  std::string words;
  if (total > 0 && done >= 0) words = fmt::format("{:.0f} %", 100 * std::min(done / total, 1.0));
  if (left >= 0) words += fmt::format("{}{:.0f} s left", words.empty() ? "" : ", ", left);
  const Json note = progress.value("note", Json());
  if (note.is_string()) words += (words.empty() ? "" : ", ") + note.get<std::string>();
  return words;
}

}  // namespace

Session::Session(std::string folder, std::string in_use, std::string preview, size_t steps,
                 bool quiet)
    : folder_(std::move(folder)),
      in_use_(std::move(in_use)),
      preview_(std::move(preview)),
      form_(progress_form(quiet)),
      steps_(steps) {}

Session::~Session() {
  clear();
  first_preview_.reset();
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void Session::clear() {
  if (line_visible_) std::fputs("\r\033[K", stderr);
  line_visible_ = false;
}

void Session::show(const std::string& how_far) {
  shown_ = Clock::now();
  if (form_ != ProgressForm::automatic) return;
  const std::string line = fmt::format("\r\033[K[{}/{}] {}{}{}", step_, steps_, title_,
                                       how_far.empty() ? "" : ": ", how_far);
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
  line_visible_ = true;
}

void Session::begin_step(const std::string& title, const std::string& program,
                         const std::string& about) {
  title_ = about.empty() ? title : title + " " + about;
  program_ = fs::path(program).filename().string();
  about_ = about;
  ++step_;
  began_ = Clock::now();
  progress_.clear();
  show("");
  if (form_ != ProgressForm::json) return;
  const Json json{{"step", step_}, {"steps", steps_}, {"title", title_}, {"program", program_}};
  say(Json{{"progress", json}}.dump());
}

void Session::print(const std::string& line) {
  Json json = line.starts_with("{\"progress\"") ? Json::parse(line, nullptr, false) : Json();
  if (!json.is_object() || !json.contains("progress") || !json["progress"].is_object()) {
    const size_t colon = line.find(": "), at = colon == line.npos ? 0 : colon + 2;
    if (!printed_.insert(line.substr(at)).second) return;
    clear();
    say(line.substr(0, at) + (about_.empty() ? "" : about_ + ": ") + line.substr(at));
    return;
  }
  Json& progress = json["progress"];
  progress_ = words_of(progress);
  show(progress_);
  if (form_ != ProgressForm::json) return;
  progress["step"] = step_, progress["steps"] = steps_;
  progress["title"] = title_, progress["program"] = program_;
  say(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void Session::begin_first_preview(Words words) {
  append(words, {"-o", path_of("first.exr")});
  first_preview_ = std::make_unique<ChildProcess>(words, ChildProcess::How{false, "", kNice});
}

void Session::publish_preview() {
  const std::string png = path_of(first_preview_ ? "first.png" : "picture.png");
  std::error_code failed;
  const auto time = fs::last_write_time(png, failed);
  if (preview_.empty() || failed || time == preview_time_) return;
  preview_time_ = time;
  write_output(preview_, read_file(png));
}

int Session::run(const Words& words, const ChildProcess::How& how, std::string* explained) {
  constexpr int kStopped = static_cast<int>(Exit::interrupted);
  if (stop_requested()) return kStopped;
  ChildProcess child(words, how);
  std::string text, unheard;
  bool is_stopping = false;
  const auto take_lines = [&] {
    for (size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
      const std::string line = text.substr(0, end);
      if (explained && !line.starts_with('{')) *explained += line + "\n";
      if (!explained || line.find(kDecision) == std::string::npos) print(line);
    }
  };
  std::error_code ignored;
  while (!child.exit_code()) {
    child.read(text);
    take_lines();
    if (stop_requested() && !std::exchange(is_stopping, true)) child.send(SIGTERM);
    if (first_preview_) first_preview_->read(unheard);
    try {
      publish_preview();
    } catch (const Error&) {  // the final write will report an error
    }
    for (const std::string& folder : {folder_, in_use_})
      fs::last_write_time(folder, fs::file_time_type::clock::now(), ignored);
    if (const auto now = Clock::now(); now - shown_ > kEvery)
      show(!progress_.empty()
               ? progress_
               : fmt::format("{:.0f} s", std::chrono::duration<double>(now - began_).count()));
    pollfd wait{child.descriptor(), POLLIN, 0};
    ::poll(&wait, 1, child.descriptor() < 0 ? 10 : 100);
  }
  child.read(text);
  text += text.empty() || text.ends_with('\n') ? "" : "\n";
  take_lines();
  const int code = *child.exit_code();
  if (stop_requested()) return kStopped;
  if (code < 128) return code;
  throw Error(Exit::internal,
              fmt::format("{}: was ended by signal {}{}", fs::path(words[0]).filename().string(),
                          code - 128, code == 128 + SIGKILL ? ", perhaps for want of memory" : ""));
}

void Session::need(const Words& words, const ChildProcess::How& how, std::string* explained) {
  if (const int code = run(words, how, explained); code != 0) throw ProgramEnded{code};
}

}  // namespace tdpt
