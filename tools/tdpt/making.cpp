#include "tools/tdpt/making.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/process.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/outputs.h"
#include "libcommon/formats/tone.h"
#include "libcommon/options/picture_options.h"
#include "tools/tdpt/shot_report.h"

namespace tdpt {
namespace {

namespace fs = std::filesystem;

constexpr int kStopped = static_cast<int>(Exit::interrupted);
constexpr const char* kDecision = ", because ";  // in sentences of --explain
constexpr int kNice = 10;                        // of a first preview: the stages have priority

struct Ended {
  int code;  // of a program that failed or was stopped
};

std::string name_of(const std::string& program) {
  return fs::path(program).filename().string();
}

bool exists(const std::string& path) {
  std::error_code failed;
  return fs::exists(path, failed);
}

// Of the file at that path; "" if there is none.
std::string hash_at(const std::string& path) {
  std::error_code failed;
  return fs::is_regular_file(path, failed) ? content_hash_of_file(path) : "";
}

std::string variable(const char* name, const char* usual) {
  const char* value = std::getenv(name);
  return value && *value ? value : usual;
}

// Absolute, even if the current folder no longer exists.
std::string full_path(const std::string& path) {
  std::error_code failed;
  const fs::path full = fs::absolute(path, failed);
  return failed ? path : full.string();
}

void append(Words& words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
}

Words exposure_words(const Arguments& a) {
  return a.exposure ? Words{fmt::format("--exposure={}", *a.exposure)} : Words{};
}

}  // namespace

Making::Making(const Arguments& a, const cli::Common& common, ProgressForm form)
    : a_(a),
      common_(common),
      request_(request_of(a, common)),
      work_(full_path(a.work.empty() ? WorkFolder::usual_path() : a.work)),
      programs_(program_folder()),
      state_(state_of(a)),
      pipeline_(pipeline_of(a, common, request_, state_, work_, programs_)),
      run_(work_.path_of(fmt::format("run-{}-{}", ::getpid(),
                                     std::chrono::system_clock::now().time_since_epoch().count()))),
      conversation_(form, common.quiet) {}

Making::~Making() {
  look_.reset();
  std::error_code ignored;
  fs::remove_all(run_, ignored);
}

Making::Result Making::preview() const {
  return {a_.preview, "preview of " + hash_at(request_.picture) + shell_text(exposure_words(a_))};
}

Making::Result Making::report() const {
  return {a_.report,
          fmt::format("{} report {} {} {}", pipeline_.key, variable("REPORT_TIME", "10"),
                      variable("REPORT_REFERENCE", "8"), variable("REPORT_WIDTH", "320"))};
}

std::vector<Making::Result> Making::files_beside() const {
  return {{a_.stats, pipeline_.key + " stats"}, {a_.nonzero, pipeline_.key + " nonzero"}};
}

bool Making::is_there(const Result& result) const {
  return result.path.empty() || work_.knows(hash_at(result.path), result.key);
}

// The picture and all that its rendering writes. A preview can be made of the picture.
bool Making::is_fresh() const {
  const auto beside = files_beside();
  return pipeline_.repeatable && is_there(picture()) &&
         std::all_of(beside.begin(), beside.end(), [&](const Result& r) { return is_there(r); });
}

void Making::know(const Result& result) const {
  if (const std::string hash = hash_at(result.path); !hash.empty()) work_.know(hash, result.key);
}

// Throws UsageError for files that are not tdpt's to replace.
void Making::check_owners() const {
  if (a_.force) return;
  if (!request_.is_shot) {
    const std::string hash = hash_at(request_.picture);
    if (hash.empty() || work_.knows(hash, "")) return;
    throw UsageError(request_.picture +
                     ": is there already, and tdpt did not make it; --force replaces it");
  }
  const FrameRange range = frame_range(a_.shot);
  for (int64_t k = range.first; k <= range.last; ++k) {
    check_is_frame(name_of_frame("-o", request_.picture, k));
    if (!request_.stats.empty() && a_.stats.empty())
      check_is_stats(name_of_frame("--stats", request_.stats, k));
  }
}

bool Making::has_changed() const {
  try {
    return state_of(a_) != state_;
  } catch (const InputError&) {
    return true;  // it is being replaced
  }
}

int Making::run() {
  common_.also_read(state_.files);
  int code = 0;
  try {
    make();
  } catch (const Ended& ended) {
    code = ended.code;
    if (code == kStopped)
      common_.note("stopped while " + doing_ + "; " + left_ + "; the same command goes on");
  }
  if (code == 0 && !common_.dependencies.empty())
    write_output(common_.dependencies, common_.dependency_rule());
  work_.shrink_to(*parse_size(a_.work_size));
  return code;
}

void Making::make() {
  const bool made = is_fresh();
  const bool reported = a_.report.empty() || (pipeline_.repeatable && is_there(report()));
  if (made && !is_there(preview())) make_preview();
  if (made && reported) return common_.note(request_.picture + " is up to date");
  work_.use(name_of(run_));
  if (!pipeline_.entry.empty()) work_.use(pipeline_.entry);
  if (!made) check_owners();
  left_ = made ? request_.picture + " is whole" : "nothing is rendered yet";
  steps_ = !made + !a_.report.empty() + !pipeline_.filtered.empty();
  for (const Search& search : pipeline_.searches)
    if (!exists(search.found())) steps_ += search.stages.size();

  // What can be checked before the first stage: the renderer's options, its files, its device.
  doing_ = "reading the scene";
  begin_step(doing_, "tdpt-render");
  step_ = 0;
  if (!a_.report.empty() && run_program({"python3", "-c", ""}) != 0)
    throw UsageError("--report: needs python3");
  need(pipeline_.check);
  find_portals();
  if (!made && request_.is_shot) render_frames();
  if (!made && !request_.is_shot) render();
  if (!reported) make_report();

  std::string files = made ? "" : request_.picture;
  for (const std::string& path : {a_.preview, a_.stats, a_.nonzero, a_.report})
    if (!path.empty() && exists(path)) files += (files.empty() ? "" : ", ") + path;
  common_.note("wrote " + files);
}

void Making::find_portals() {
  doing_ = "looking for portals";
  if (!state_.drawn.empty())
    common_.note("renders with " + state_.drawn +
                 ", which lies beside the scene: no others are searched for");
  for (const Search& search : pipeline_.searches) {
    work_.use(search.entry);
    if (!exists(search.found()))
      for (const Step& step : search.stages) run_stage(search, step);
    if (pipeline_.portals_by_frame.empty()) continue;
    const std::string bytes = read_file(search.found());
    for (int64_t k = search.frames.first; k <= search.frames.last; ++k)
      write_output(name_of_frame("", pipeline_.portals_by_frame, k), bytes);
  }
  look_.reset();
}

void Making::run_stage(const Search& search, const Step& step) {
  begin_step(step.title, step.options[0], Of::all);
  if (exists(step.output)) return;
  if (!a_.preview.empty() && !request_.is_shot && !look_) {
    Words words{programs_ + "/tdpt-render", request_.scene};
    for (const Words* more : {&request_.camera, &request_.pose, &request_.sky, &request_.unshaped})
      append(words, *more);
    append(words, {"--integrator", "bdpt", "--spp", "256", "--quiet", "--preview"});
    if (a_.width > 0) append(words, {"--width", std::to_string(a_.width)});
    if (a_.height > 0) append(words, {"--height", std::to_string(a_.height)});
    append(words, exposure_words(a_));
    append(words, {"-o", run_ + "/look.exr"});
    look_ = std::make_unique<ChildProcess>(words, ChildProcess::How{false, "", kNice});
  }
  Words words = step.command(step.output);
  if (name_of(words[0]) == "lightgrid")  // the others are short and report no progress
    append(words, {"--set", "progress=json"});
  const bool reads_scene = step.inputs[0] == request_.scene;
  const bool tells = !a_.report.empty() && !request_.is_shot;  // of itself, for the report
  ChildProcess::How how;
  std::string told;
  if (tells) {
    how.stdout_file = step.output + ".told.json";
    // The plan of the portals has words to read.
    const bool is_plan = step.output.ends_with(".portal.glb");
    append(words, {"--json", "--explain", "--preview",
                   step.output + (is_plan ? ".told.svg" : ".told.png")});
    if (!reads_scene) {
      append(words, {"--scene", request_.scene});
      append(words, request_.pose);
    }
  }
  write_output(step.output + ".command", shell_text(step.options) + "\n");
  const int code = run_program(words, how, tells ? &told : nullptr);
  if (reads_scene && code != kStopped && has_changed()) {
    fs::remove_all(work_.path_of(search.entry));  // it is of another scene than its key says
    throw InputError(request_.scene, "", "has changed while tdpt was at work; start it again");
  }
  if (code != 0) throw Ended{code};
  if (tells) write_output(step.output + ".told.txt", told);
}

// Of the picture that is there.
void Making::make_preview() const {
  const Picture picture = read_exr(request_.picture).picture;
  const auto exposure = exposure_of(picture, a_.preview, a_.exposure);
  write_output(a_.preview, preview_bytes(picture, *exposure));
  know(preview());
  common_.note("wrote " + a_.preview);
  common_.explain_by([&] { return with_exposure({}, a_.exposure, exposure); });
}

// Copies a renderer's preview to its place whenever it has changed.
void Making::publish(const std::string& preview) {
  std::error_code failed;
  const auto time = fs::last_write_time(preview, failed);
  if (a_.preview.empty() || failed || time == preview_time_) return;
  preview_time_ = time;
  write_output(a_.preview, read_file(preview));
}

void Making::render() {
  doing_ = "rendering";
  begin_step(doing_, pipeline_.render.options[0]);
  const std::string made = run_ + "/picture.exr";
  const std::string& film = pipeline_.film;
  Words words = pipeline_.render.command(made);
  if (!asks_for_portals(request_.picture)) append(words, {"--set", "progress=json"});
  ChildProcess::How how;
  how.shares_stdout = true;
  const bool goes_on = exists(film);
  int code = run_program(words, how);
  if (goes_on &&
      (code == static_cast<int>(Exit::bad_input) || code == static_cast<int>(Exit::usage))) {
    common_.note("what the run before left cannot be used; begins with the first sample");
    std::error_code ignored;
    fs::remove(film, ignored);
    code = run_program(words, how);
  }
  if (code == 0 || (code == kStopped && exists(made))) place(code == 0);
  if (code != 0) throw Ended{code};
  std::error_code ignored;
  if (film != pipeline_.shared_film && exists(film)) {
    work_.use(name_of(fs::path(pipeline_.shared_film).parent_path()));
    if (!exists(pipeline_.shared_film)) fs::rename(film, pipeline_.shared_film, ignored);
    fs::remove_all(work_.path_of(pipeline_.entry), ignored);
  }
}

// The picture's maker is recorded before the picture gets its name, so that it is known however
// this process ends.
void Making::place(bool whole) {
  const std::string made = run_ + "/picture.exr";
  publish(cli::png_beside(made));
  const bool of_another = whole && has_changed();
  if (of_another)
    common_.note(request_.scene +
                 " has changed while tdpt was at work; the same command renders it");
  const bool is_known = whole && !of_another;
  try {
    know({made, is_known ? pipeline_.key : "of no command"});
    for (const Result& beside : files_beside())
      if (is_known) know(beside);
  } catch (const OutputError& e) {
    common_.warn(std::string(e.what()) + "; tdpt will not know that it made the picture");
  }
  write_output(request_.picture, read_file(made));
  know(preview());
  left_ = request_.picture + (whole ? " is whole" : " has what was rendered until then");
}

// Frames that are to be filtered and are not there as they would be.
std::vector<FilteredFrame> Making::missing_frames() const {
  std::vector<FilteredFrame> missing;
  for (const FilteredFrame& frame : pipeline_.filtered)
    if (!is_there({frame.picture, frame.key})) missing.push_back(frame);
  return missing;
}

// The renderer writes each frame when it is whole, and renders none again that is.
void Making::render_frames() {
  doing_ = "rendering";
  left_ = "the frames that are there stay";
  begin_step("rendering frames", pipeline_.render.options[0]);
  ChildProcess::How how;
  how.shares_stdout = true;
  std::vector<FrameRange> runs{frame_range(a_.shot)};
  if (!pipeline_.filtered.empty()) {
    runs = with_those_beside(missing_frames(), runs[0]);
    fs::create_directories(fs::path(pipeline_.noisy).parent_path());
  }
  for (const FrameRange& run : runs) {
    Words words = command_for(pipeline_.render, run);
    append(words, {"--set", "progress=json"});
    need(words, how);
  }
  if (!pipeline_.filtered.empty()) filter_frames();
  std::error_code ignored;
  fs::remove_all(work_.path_of(pipeline_.entry), ignored);
}

// A frame's maker is recorded before it gets its name, as that of a picture.
void Making::filter_frames() {
  doing_ = "filtering frames";
  begin_step(doing_, "exrdenoise");
  const std::string made = run_ + "/frame.exr", told = run_ + "/told.json";
  const std::vector<FilteredFrame> missing = missing_frames();
  if (const size_t there = pipeline_.filtered.size() - missing.size(); there > 0)
    common_.note(counted(there, "filtered frame") + (there == 1 ? " is" : " are") +
                 " there already");
  for (const FilteredFrame& frame : missing) {
    Words words = frame.command;
    append(words, {"--json", "-o", made});
    ChildProcess::How how;
    how.stdout_file = told;
    need(words, how);
    know({made, frame.key});
    write_output(frame.picture, read_file(made));
    if (!request_.stats.empty())
      write_filtered_stats(name_of_frame("", pipeline_.noisy + ".json", frame.number), told,
                           name_of_frame("--stats", request_.stats, frame.number));
  }
  // Previews of one exposure do not flicker.
  std::optional<double> exposure = a_.exposure;
  for (const FilteredFrame& frame : pipeline_.filtered) {
    if (a_.preview.empty()) break;
    const Picture picture = read_exr(frame.picture).picture;
    if (!exposure) {
      exposure = auto_exposure(picture);
      common_.note(fmt::format("previews are exposed as frame {}: --exposure {}", frame.number,
                               number_words(*exposure)));
    }
    write_output(name_of_frame("--preview", a_.preview, frame.number),
                 preview_bytes(picture, *exposure));
  }
}

void Making::make_report() {
  doing_ = "measuring for the report";
  const std::string scripts = programs_ + "/../share/tdpt/", parts = run_ + "/report";
  const std::string page = run_ + "/report.html";
  if (request_.is_shot) {
    begin_step("writing the report", "report_shot.py");
    fs::create_directories(parts);
    gather_shot(a_, request_, parts);
  } else {
    begin_step(doing_, "report_measure.py");
    Words measure{"python3", "-B", scripts + "report_measure.py", "--scene", request_.scene};
    append(measure, {"--folder", parts, "--time", variable("REPORT_TIME", "10")});
    append(measure, {"--reference", variable("REPORT_REFERENCE", "8")});
    append(measure, {"--width", variable("REPORT_WIDTH", "320")});
    append(measure, {"--exrdiff", programs_ + "/exrdiff", "--info", programs_ + "/tdpt-info"});
    if (!pipeline_.searches.empty())
      for (const char* option : {"--stem", "--known"})
        append(measure, {option, work_.path_of(pipeline_.searches[0].entry) + "/scene"});
    if (common_.threads > 0) append(measure, {"--threads", std::to_string(common_.threads)});
    if (common_.quiet) measure.emplace_back("--quiet");
    append(measure, {"--progress", "--"});
    append(measure, pipeline_.render.options);
    append(measure, Words(pipeline_.render.inputs.begin() + 1, pipeline_.render.inputs.end()));
    need(measure);
  }
  need({"python3", "-B", scripts + (request_.is_shot ? "report_shot.py" : "report_page.py"), parts,
        page});
  write_output(a_.report, read_file(page));
  know(report());
}

void Making::begin_step(const std::string& title, const std::string& program, Of of) {
  const std::string about = a_.views.empty() || of == Of::all ? "" : request_.picture;
  ++step_;
  conversation_.step(step_, std::max(step_, steps_), about.empty() ? title : title + " " + about,
                     name_of(program), about);
}

int Making::run_program(const Words& words, const ChildProcess::How& how, std::string* told) {
  if (stop_requested()) return kStopped;
  ChildProcess child(words, how);
  std::string text, unheard;
  bool told_to_stop = false;
  const auto hear = [&] {
    for (size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
      const std::string line = text.substr(0, end);
      if (told && !line.starts_with('{')) *told += line + "\n";
      if (!told || line.find(kDecision) == std::string::npos) conversation_.heard(line);
    }
  };
  std::error_code ignored;
  while (!child.exit_code()) {
    child.read(text);
    hear();
    if (stop_requested() && !std::exchange(told_to_stop, true)) child.send(SIGTERM);
    if (look_) look_->read(unheard);
    try {
      publish(run_ + (look_ ? "/look.png" : "/picture.png"));
    } catch (const Error&) {  // the final write will report an error
    }
    // A folder that is in use is not old.
    for (const std::string& folder : {run_, work_.path_of(pipeline_.entry)})
      fs::last_write_time(folder, fs::file_time_type::clock::now(), ignored);
    conversation_.tick();
    pollfd wait{child.descriptor(), POLLIN, 0};
    ::poll(&wait, 1, child.descriptor() < 0 ? 10 : 100);
  }
  child.read(text);
  text += text.empty() || text.ends_with('\n') ? "" : "\n";
  hear();
  const int code = *child.exit_code();
  if (stop_requested()) return kStopped;
  if (code < 128) return code;
  throw Error(Exit::internal,
              fmt::format("{}: was ended by signal {}{}", name_of(words[0]), code - 128,
                          code == 128 + SIGKILL ? ", perhaps for want of memory" : ""));
}

void Making::need(const Words& words, const ChildProcess::How& how) {
  if (const int code = run_program(words, how); code != 0) throw Ended{code};
}

void Making::print(std::set<std::string>& printed) {
  common_.also_read(state_.files);
  std::string commands;
  const auto add = [&](Words words, const Words& more = {}) {
    append(words, more);
    commands += shell_text(words) + "\n";
  };
  if (is_fresh()) {
    if (is_there(preview()))
      common_.note(request_.picture + " is up to date");
    else
      add({programs_ + "/exrmerge", request_.picture, "-o", a_.preview}, exposure_words(a_));
    std::fputs(commands.c_str(), stdout);
    return;
  }
  check_owners();
  Words folders{"mkdir", "-p"};
  if (!pipeline_.film.empty() || !pipeline_.portals_by_frame.empty())
    folders.push_back(work_.path_of(pipeline_.entry));
  if (!pipeline_.filtered.empty())
    folders.push_back(fs::path(pipeline_.noisy).parent_path().string());
  for (const Search& search : pipeline_.searches) {
    if (!printed.insert(search.entry).second) continue;
    if (!exists(search.found())) folders.push_back(work_.path_of(search.entry));
    for (const Step& step : search.stages)
      if (!exists(step.output)) add(step.command(step.output));
    if (pipeline_.portals_by_frame.empty()) continue;
    for (int64_t k = search.frames.first; k <= search.frames.last; ++k)
      add({"cp", search.found(), name_of_frame("", pipeline_.portals_by_frame, k)});
  }
  if (folders.size() > 2) commands = shell_text(folders) + "\n" + commands;
  if (pipeline_.filtered.empty()) add(pipeline_.render.command(request_.picture));
  const std::vector<FilteredFrame> missing = missing_frames();
  if (!missing.empty())
    for (const FrameRange& run : with_those_beside(missing, frame_range(a_.shot)))
      add(command_for(pipeline_.render, run));
  for (const FilteredFrame& frame : missing) {
    Words words = frame.command;
    append(words, {"-o", frame.picture});
    if (!a_.preview.empty()) words.emplace_back("--preview");
    add(words, exposure_words(a_));
  }
  std::fputs(commands.c_str(), stdout);
}

}  // namespace tdpt
