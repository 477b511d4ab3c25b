#include "tools/tdpt/conversation.h"

#include <cstdio>

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include "libcommon/base/progress.h"

namespace tdpt {
namespace {

using Json = nlohmann::ordered_json;

constexpr auto kEvery = std::chrono::milliseconds(300);

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

Conversation::Conversation(bool quiet) : form_(progress_form(quiet)) {}

Conversation::~Conversation() {
  clear();
}

void Conversation::clear() {
  if (visible_) std::fputs("\r\033[K", stderr);
  visible_ = false;
}

void Conversation::show(const std::string& how_far) {
  shown_ = Clock::now();
  if (form_ != ProgressForm::automatic) return;
  const std::string line = fmt::format("\r\033[K[{}/{}] {}{}{}", number_, steps_, title_,
                                       how_far.empty() ? "" : ": ", how_far);
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
  visible_ = true;
}

void Conversation::step(size_t number, size_t steps, const std::string& title,
                        const std::string& program, const std::string& about) {
  number_ = number, steps_ = steps, title_ = title, program_ = program, about_ = about;
  began_ = Clock::now();
  reported_.clear();
  show("");
  if (form_ != ProgressForm::json) return;
  const Json json{{"step", number}, {"steps", steps}, {"title", title}, {"program", program}};
  say(Json{{"progress", json}}.dump());
}

void Conversation::print(const std::string& line) {
  const bool is_progress = line.starts_with("{\"progress\"");
  Json json = is_progress ? Json::parse(line, nullptr, false) : Json();
  if (!json.is_object() || !json.contains("progress") || !json["progress"].is_object()) {
    const size_t colon = line.find(": "), at = colon == line.npos ? 0 : colon + 2;
    if (!said_.insert(line.substr(at)).second) return;
    clear();
    say(line.substr(0, at) + (about_.empty() ? "" : about_ + ": ") + line.substr(at));
    return;
  }
  Json& progress = json["progress"];
  reported_ = words_of(progress);
  if (form_ == ProgressForm::json) {
    progress["step"] = number_, progress["steps"] = steps_;
    progress["title"] = title_, progress["program"] = program_;
    say(json.dump(-1, ' ', false, Json::error_handler_t::replace));
  } else {
    show(reported_);
  }
}

void Conversation::tick() {
  const auto now = Clock::now();
  if (form_ != ProgressForm::automatic || now - shown_ < kEvery) return;
  const double seconds = std::chrono::duration<double>(now - began_).count();
  show(reported_.empty() ? fmt::format("{:.0f} s", seconds) : reported_);
}

}  // namespace tdpt
