#include "tools/tdpt/making.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <poll.h>

#include "libcommon/base/counted.h"
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/hash.h"
#include "libcommon/base/memory_limit.h"
#include "libcommon/base/number_words.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/signals.h"
#include "libcommon/cli/outputs.h"
#include "libcommon/formats/tone.h"
#include "libcommon/options/picture_options.h"
#include "tools/tdpt/shot_report.h"

namespace tdpt {
namespace {

namespace fs = std::filesystem;

constexpr int kStopped = static_cast<int>(Exit::interrupted);
constexpr const char* kDecision = ", because ";          // in sentences of --explain
constexpr const char* kPicture = "partial-picture.exr";  // the renderer's output
constexpr const char* kPartial = "partial-";             // prefix of results that are not complete

std::string name_of(const std::string& program) {
  return fs::path(program).filename().string();
}

// Removes what a killed run left in an entry, except the names in `stays`.
void clear(const std::string& folder, const std::vector<std::string>& stays) {
  std::error_code ignored;
  for (const auto& file : fs::directory_iterator(folder, ignored))
    if (std::find(stays.begin(), stays.end(), file.path().filename().string()) == stays.end())
      fs::remove_all(file.path(), ignored);
}

bool is_there(const std::string& path) {
  std::error_code failed;
  return fs::exists(path, failed);
}

// Whether a stage's result still has the hash stored when it was complete: damaged files do not.
bool is_whole(const std::string& result) {
  try {
    return is_there(result) && read_file(result + ".hash") == content_hash_of_file(result) + "\n";
  } catch (const InputError&) {
    return false;
  }
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

// Settings that affect a report, apart from the picture.
std::string report_settings() {
  return variable("REPORT_TIME", "10") + " " + variable("REPORT_REFERENCE", "8") + " " +
         variable("REPORT_WIDTH", "320");
}

// Throws OutputError naming the file: nothing else can be done here.
void rename_whole(const std::string& from, const std::string& to) {
  std::error_code failed;
  fs::rename(from, to, failed);
  if (failed) throw OutputError(to, "cannot be made: " + failed.message());
}

}  // namespace

Making::Making(const Arguments& a, const cli::Common& common, ProgressForm form)
    : a_(a),
      common_(common),
      request_(request_of(a, common)),
      work_(full_path(a.work.empty() ? WorkFolder::usual_path() : a.work)),
      programs_(program_folder()),
      conversation_(form, common.quiet) {}

bool Making::has_changed() const {
  if (stop_requested()) return false;  // the run ends anyway
  try {
    return !(state_of(a_, work_) == state_);
  } catch (const InputError&) {
    return true;  // it is being replaced
  }
}

// Waits until a scene that is being written seems complete.
void Making::settle() {
  for (int i = 0; i < 20 && !stop_requested(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    if (!has_changed()) return;
    try {
      state_ = state_of(a_, work_);
    } catch (const InputError&) {
    }
  }
}

bool Making::report_is_fresh() const {
  if (a_.report.empty()) return true;
  const std::string now = hash_of_picture(a_.report) + " " + report_settings();
  for (const Made& made : made_of(hash_of_picture(request_.picture), work_))
    if (const auto then = made.beside.find("--report");
        made.key == pipeline_.key && then != made.beside.end() && then->second == now)
      return true;
  return false;
}

bool Making::all_is_fresh() const {
  return is_fresh(a_, request_, pipeline_, work_) &&
         preview_is_fresh(a_, request_, pipeline_, work_) && report_is_fresh();
}

// Called while another run holds an entry: prints `sentence` once, and throws after a signal.
std::function<void()> Making::waits(const std::string& sentence) const {
  return [this, sentence, told = false]() mutable {
    if (stop_requested()) throw Error(Exit::interrupted, "stopped by a signal");
    if (!std::exchange(told, true)) common_.note(sentence);
  };
}

void Making::hold_picture() {
  picture_ =
      work_.hold(pipeline_.picture_entry, WorkFolder::For::writing,
                 waits(request_.picture + ": another run of tdpt is making it; waiting for that"));
}

int Making::run() {
  for (int changes = 0;; ++changes) {
    state_ = state_of(a_, work_);
    pipeline_ = pipeline_of(a_, common_, request_, state_, work_, programs_);
    if (!all_is_fresh() && picture_.path().empty()) {
      hold_picture();
      state_ = state_of(a_, work_);  // another run may have made it in the meantime
      pipeline_ = pipeline_of(a_, common_, request_, state_, work_, programs_);
    }
    common_.also_read(state_.files);
    if (is_fresh(a_, request_, pipeline_, work_)) mend_preview();
    if (all_is_fresh()) {
      common_.note(request_.picture + " is up to date");
      tell_end(0);
      return 0;
    }
    const Ending ending = attempt();
    look_.reset();
    portals_ = {};
    if (!ending.changed) {
      tell_end(ending.code);
      return ending.code;
    }
    if (changes > 0)
      throw InputError(request_.scene, "",
                       "has changed again while tdpt was at work; start it again when it is whole");
    common_.note(request_.scene + " has changed while tdpt was at work, which begins again");
    settle();
  }
}

// Writes the dependency file, and limits the size of the work folder.
void Making::tell_end(int code) const {
  if (code == 0 && !common_.dependencies.empty())
    write_output(common_.dependencies, common_.dependency_rule());
  if (const auto most = parse_size(a_.work_size)) work_.shrink_to(*most);
}

// Throws UsageError for files that are not tdpt's to replace.
void Making::check_owners() const {
  if (!request_.is_shot) return check_is_ours(request_.picture, work_);
  const FrameRange range = frame_range(a_.shot);
  for (int64_t k = range.first; k <= range.last; ++k) {
    check_is_frame(name_of_frame("-o", request_.picture, k));
    if (!request_.stats.empty() && a_.stats.empty())
      check_is_stats(name_of_frame("--stats", request_.stats, k));
  }
}

Making::Ending Making::attempt() {
  const std::string folder = picture_.path();
  ::setenv("TDPT_TOLD", (folder + "/told").c_str(), 0);
  const bool made = is_fresh(a_, request_, pipeline_, work_);
  if (!made) {
    if (!a_.force) check_owners();
    before_ = hash_of_picture(request_.picture);
    std::vector<std::string> stays = what_stays();
    stays.emplace_back("noisy");  // frames that a killed run has rendered
    clear(folder, stays);
  }
  left_ = made ? request_.picture + " is whole" : "nothing is rendered yet";
  step_ = 0;
  steps_ = !made + !a_.report.empty() + !pipeline_.filtered.empty();
  for (const Search& search : pipeline_.searches)
    if (!is_whole(search.found())) steps_ += search.stages.size();
  Ending ending = check();
  if (ending.good()) ending = find_portals();
  if (ending.good() && !made) ending = render();
  if (ending.good() && !report_is_fresh()) ending = make_report();
  if (ending.code == kStopped)
    common_.note("stopped while " + doing_ + "; " + left_ + "; the same command goes on");
  if (ending.good()) {
    const std::vector<std::string> stays = what_stays();
    std::error_code ignored;
    if (stays.size() == 1) fs::remove_all(folder, ignored);
    clear(folder, stays);
    std::string files = made ? "" : request_.picture;
    for (const std::string& path : {a_.preview, a_.stats, a_.nonzero, a_.report})
      if (!path.empty() && is_there(path)) files += (files.empty() ? "" : ", ") + path;
    common_.note("wrote " + files);
  }
  return ending;
}

// One of several is named.
std::string Making::title_of_picture(const std::string& title) const {
  return a_.views.empty() ? title : title + " " + request_.picture;
}

// In the picture's entry, from one run to the next.
std::vector<std::string> Making::what_stays() const {
  if (!goes_on(pipeline_, picture_.path())) return {"lock"};
  return {"lock", "film-of", "film.exr"};
}

// Checks what can be checked before the first stage: the renderer's options, its files, its device.
Making::Ending Making::check() {
  doing_ = "reading the scene";
  conversation_.step(1, steps_, doing_, "tdpt-render");
  if (!a_.report.empty() && !run_program({"python3", "-c", ""}, {}, Reads::files).good())
    throw UsageError("--report: needs python3");
  return run_program(pipeline_.check, {}, Reads::scene);
}

Making::Ending Making::find_portals() {
  doing_ = "looking for portals";
  if (!state_.drawn.empty())
    common_.note("renders with " + state_.drawn +
                 ", which lies beside the scene: no others are searched for");
  for (const Search& search : pipeline_.searches) {
    if (const Ending ending = find_portals(search); !ending.good()) return ending;
    if (pipeline_.portals_by_frame.empty()) continue;
    const std::string bytes = read_file(search.found());
    for (int64_t k = search.frames.first; k <= search.frames.last; ++k)
      write_output(name_of_frame("", pipeline_.portals_by_frame, k), bytes);
  }
  return {};
}

Making::Ending Making::find_portals(const Search& search) {
  const auto wait = waits("another run of tdpt is looking for the same portals; waiting for it");
  portals_ = {};
  for (;;) {
    portals_ = work_.hold(search.entry, WorkFolder::For::reading, wait);
    if (is_whole(search.found())) break;
    portals_ = {};
    portals_ = work_.hold(search.entry, WorkFolder::For::writing, wait);
    if (!is_whole(search.found()))
      if (const Ending ending = run_stages(search); !ending.good()) return ending;
    portals_ = {};  // from here on it is held for reading
  }
  return {};
}

Making::Ending Making::run_stages(const Search& search) {
  const bool tells = !a_.report.empty() && !request_.is_shot;  // of itself, for the report
  std::vector<std::string> whole{"lock"};
  for (const Step& step : search.stages) {
    whole.push_back(name_of(step.output));
    for (const char* end :
         {".hash", ".command", ".told.json", ".told.txt", ".told.png", ".told.svg"})
      whole.push_back(name_of(step.output) + end);
  }
  clear(portals_.path(), whole);
  if (!a_.preview.empty() && !request_.is_shot)
    look_ = std::make_unique<FirstLook>(a_, request_, programs_, picture_.path(), a_.preview);
  for (const Step& step : search.stages) {
    begin_step(step.title, step.options);
    if (is_whole(step.output)) continue;
    const std::string partial = portals_.path() + "/" + kPartial + name_of(step.output);
    Words words = step.command(partial);
    if (name_of(step.options[0]) == "lightgrid")  // the others are short and report no progress
      words.insert(words.end(), {"--set", "progress=json"});
    const bool reads_scene =
        std::find(step.inputs.begin(), step.inputs.end(), request_.scene) != step.inputs.end();
    ChildProcess::How how;
    std::string told;
    if (tells) {
      how.stdout_file = step.output + ".told.json";
      // The plan of the portals has words to read.
      const bool is_plan = step.output.ends_with(".portal.glb");
      words.insert(words.end(), {"--json", "--explain", "--preview",
                                 step.output + (is_plan ? ".told.svg" : ".told.png")});
      if (is_plan || (!reads_scene && step.output.ends_with(".cut"))) {
        words.insert(words.end(), {"--scene", request_.scene});
        words.insert(words.end(), request_.pose.begin(), request_.pose.end());
      }
    }
    const Ending ending = run_program(words, how, reads_scene ? Reads::scene : Reads::files,
                                      Of::all, tells ? &told : nullptr);
    if (!ending.good()) return ending;
    if (tells) write_output(step.output + ".told.txt", told);
    write_output(step.output + ".command", shell_text(step.options) + "\n");
    write_output(step.output + ".hash", content_hash_of_file(partial) + "\n");
    rename_whole(partial, step.output);
  }
  look_.reset();
  return {};
}

// Makes the preview of the picture that is there.
void Making::mend_preview() {
  if (preview_is_fresh(a_, request_, pipeline_, work_)) return;
  const Picture picture = read_exr(request_.picture).picture;
  const auto exposure = exposure_of(picture, a_.preview, a_.exposure);
  write_output(a_.preview, preview_bytes(picture, *exposure));
  keep({pipeline_.key, true, files_written_beside(a_)}, hash_of_picture(request_.picture), work_);
  common_.note("wrote " + a_.preview);
  common_.explain_by([&] { return with_exposure({}, a_.exposure, exposure); });
}

// Copies the renderer's preview to its place whenever it has changed.
void Making::publish_preview() {
  std::error_code failed;
  const std::string png = cli::png_beside(picture_.path() + "/" + kPicture);
  const auto time = fs::last_write_time(png, failed);
  if (a_.preview.empty() || failed || time == preview_time_) return;
  preview_time_ = time;
  write_output(a_.preview, read_file(png));
}

// The picture's maker is recorded before the picture gets its name, so that it is known however
// this process ends.
void Making::place(bool whole) {
  const std::string made = picture_.path() + "/" + kPicture;
  publish_preview();
  if (!a_.force && hash_of_picture(request_.picture) != before_)
    throw OutputError(request_.picture,
                      "was written by another program while tdpt was at work; its "
                      "own picture is kept as " +
                          made);
  const std::string bytes = read_file(made), hash = content_hash(bytes);
  try {
    keep({pipeline_.key, whole, files_written_beside(a_)}, hash, work_);
  } catch (const OutputError& e) {
    common_.warn(std::string(e.what()) + "; tdpt will not know that it made the picture");
  }
  write_output(request_.picture, bytes);
  before_ = hash;
  left_ = request_.picture + (whole ? " is whole" : " has what was rendered until then");
}

// Frames that are to be filtered and are not there as they would be.
std::vector<FilteredFrame> Making::missing_frames() const {
  std::vector<FilteredFrame> missing;
  for (const FilteredFrame& frame : pipeline_.filtered) {
    const std::vector<Made> all = made_of(hash_of_picture(frame.picture), work_);
    if (std::none_of(all.begin(), all.end(), [&](const Made& m) { return m.key == frame.key; }))
      missing.push_back(frame);
  }
  return missing;
}

// The renderer writes each frame when it is whole, and renders none again that is.
Making::Ending Making::render_frames() {
  left_ = "the frames that are there stay";
  ChildProcess::How how;
  how.shares_stdout = true;
  std::vector<FrameRange> runs{frame_range(a_.shot)};
  if (!pipeline_.filtered.empty()) {
    runs = with_those_beside(missing_frames(), runs[0]);
    fs::create_directories(fs::path(pipeline_.noisy).parent_path());
  }
  begin_step("rendering frames", pipeline_.render.options);
  for (const FrameRange& run : runs) {
    Words words = command_for(pipeline_.render, run);
    words.insert(words.end(), {"--set", "progress=json"});
    if (const Ending ending = run_program(words, how, Reads::scene); !ending.good()) return ending;
  }
  return pipeline_.filtered.empty() ? Ending{} : filter_frames();
}

// A frame's maker is recorded before it gets its name, as that of a picture.
Making::Ending Making::filter_frames() {
  begin_step("filtering frames", {"exrdenoise"});
  doing_ = "filtering frames";
  const std::string made = picture_.path() + "/" + kPicture, told = picture_.path() + "/told.json";
  const std::vector<FilteredFrame> missing = missing_frames();
  if (const size_t there = pipeline_.filtered.size() - missing.size(); there > 0)
    common_.note(counted(there, "filtered frame") + (there == 1 ? " is" : " are") +
                 " there already");
  for (const FilteredFrame& frame : missing) {
    Words words = frame.command;
    words.insert(words.end(), {"--json", "-o", made});
    ChildProcess::How how;
    how.stdout_file = told;
    if (const Ending ending = run_program(words, how, Reads::files); !ending.good()) return ending;
    const std::string bytes = read_file(made);
    keep({frame.key, true, {}}, content_hash(bytes), work_);
    write_output(frame.picture, bytes);
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
    const std::string path = name_of_frame("--preview", a_.preview, frame.number);
    const std::string bytes = preview_bytes(picture, *exposure);
    if (hash_of_picture(path) != content_hash(bytes)) write_output(path, bytes);
  }
  return {};
}

Making::Ending Making::render() {
  doing_ = "rendering";
  if (request_.is_shot) return render_frames();
  begin_step(title_of_picture(pipeline_.render.title), pipeline_.render.options);
  const std::string made = picture_.path() + "/" + kPicture, film = picture_.path() + "/film.exr";
  if (pipeline_.keeps_film) keep_film_of(pipeline_, picture_.path());
  Words words = pipeline_.render.command(made);
  if (!asks_for_portals(request_.picture)) words.insert(words.end(), {"--set", "progress=json"});
  ChildProcess::How how;
  how.shares_stdout = true;
  const bool has_film = is_there(film);
  Ending ending = run_program(words, how, Reads::scene);
  const bool refused = ending.code == static_cast<int>(Exit::bad_input) ||
                       ending.code == static_cast<int>(Exit::usage);
  if (refused && !ending.changed && has_film) {
    common_.note("what the run before left cannot be used; begins with the first sample");
    std::error_code failed;
    fs::remove(film, failed);
    ending = run_program(words, how, Reads::scene);
  }
  if (ending.changed) return ending;
  if (ending.code == 0) {
    place(true);
    if (has_changed())
      common_.note(request_.scene +
                   " has changed since it was read: the picture is of what it was");
  } else if (ending.code == kStopped && is_there(made)) {
    place(false);
  }
  return ending;
}

Making::Ending Making::make_shot_report() {
  const std::string parts = picture_.path() + "/report", page = picture_.path() + "/report.html";
  begin_step("writing the report", {"report_shot.py"});
  std::error_code failed;
  fs::create_directories(parts, failed);
  gather_shot(a_, request_, parts);
  const Ending ending =
      run_program({"python3", "-B", programs_ + "/../share/tdpt/report_shot.py", parts, page}, {},
                  Reads::files);
  if (ending.good()) write_output(a_.report, read_file(page));
  return ending;
}

Making::Ending Making::make_report() {
  doing_ = "measuring for the report";
  if (request_.is_shot) return make_shot_report();
  const std::string scripts = programs_ + "/../share/tdpt/", parts = picture_.path() + "/report";
  const std::string page = picture_.path() + "/report.html";
  begin_step(title_of_picture("measuring for the report"), {"report_measure.py"});
  Words measure{"python3",
                "-B",
                scripts + "report_measure.py",
                "--scene",
                request_.scene,
                "--folder",
                parts,
                "--time",
                variable("REPORT_TIME", "10"),
                "--reference",
                variable("REPORT_REFERENCE", "8"),
                "--width",
                variable("REPORT_WIDTH", "320"),
                "--exrdiff",
                programs_ + "/exrdiff",
                "--info",
                programs_ + "/tdpt-info"};
  if (!pipeline_.searches.empty())
    for (const char* option : {"--stem", "--known"})
      measure.insert(measure.end(), {option, portals_.path() + "/scene"});
  if (common_.threads > 0)
    measure.insert(measure.end(), {"--threads", std::to_string(common_.threads)});
  if (common_.quiet) measure.emplace_back("--quiet");
  measure.insert(measure.end(), {"--progress", "--"});
  const Step& render = pipeline_.render;
  measure.insert(measure.end(), render.options.begin(), render.options.end());
  measure.insert(measure.end(), render.inputs.begin() + 1, render.inputs.end());
  Ending ending = run_program(measure, {}, Reads::files);
  if (ending.good())
    ending =
        run_program({"python3", "-B", scripts + "report_page.py", parts, page}, {}, Reads::files);
  if (!ending.good()) return ending;
  const std::string bytes = read_file(page);
  write_output(a_.report, bytes);
  keep({pipeline_.key, true, {{"--report", content_hash(bytes) + " " + report_settings()}}},
       hash_of_picture(request_.picture), work_);
  return {};
}

void Making::begin_step(const std::string& title, const Words& words) {
  ++step_;
  conversation_.step(step_, std::max(step_, steps_), title, name_of(words[0]));
}

Making::Ending Making::ending_of(const std::string& program, int code) const {
  if (stop_requested()) return {kStopped};
  if (code < 128) return {code};
  throw Error(Exit::internal,
              fmt::format("{}: was ended by signal {}{}", program, code - 128,
                          code == 128 + SIGKILL ? ", perhaps for want of memory" : ""));
}

Making::Ending Making::run_program(const Words& words, const ChildProcess::How& how, Reads reads,
                                   Of of, std::string* told) {
  if (stop_requested()) return {kStopped};
  const bool names_picture = !a_.views.empty() && of == Of::picture;
  if (names_picture) ::setenv("TDPT_ABOUT", request_.picture.c_str(), 1);
  ChildProcess child(words, how);
  if (names_picture) ::unsetenv("TDPT_ABOUT");
  std::string text;
  bool told_to_stop = false, looked = reads == Reads::files;
  // A program's first progress report means that it has read the scene.
  const auto hear = [&] {
    for (size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
      const std::string line = text.substr(0, end);
      if (told && !line.starts_with('{')) *told += line + "\n";
      if (told && line.find(kDecision) != std::string::npos) continue;
      if (!conversation_.heard(line) || looked) continue;
      looked = true;
      if (has_changed()) return false;
    }
    return true;
  };
  while (!child.exit_code()) {
    child.read(text);
    if (!hear()) return {0, true};
    if (stop_requested() && !std::exchange(told_to_stop, true)) child.send(SIGTERM);
    try {
      if (look_)
        look_->tick();
      else
        publish_preview();
    } catch (const Error&) {  // the final write will report an error
    }
    conversation_.tick();
    pollfd wait{child.descriptor(), POLLIN, 0};
    ::poll(&wait, 1, child.descriptor() < 0 ? 10 : 100);
  }
  child.read(text);
  text += text.empty() || text.ends_with('\n') ? "" : "\n";
  if (!hear() || (!looked && has_changed())) return {0, true};
  return ending_of(name_of(words[0]), child.exit_code().value_or(0));
}

int Making::print(std::set<std::string>& printed) {
  state_ = state_of(a_, work_);
  pipeline_ = pipeline_of(a_, common_, request_, state_, work_, programs_);
  common_.also_read(state_.files);
  if (is_fresh(a_, request_, pipeline_, work_)) {
    Words show{programs_ + "/exrmerge", request_.picture, "-o", a_.preview};
    if (a_.exposure) show.push_back(fmt::format("--exposure={}", *a_.exposure));
    if (preview_is_fresh(a_, request_, pipeline_, work_))
      common_.note(request_.picture + " is up to date");
    else
      std::fputs((shell_text(show) + "\n").c_str(), stdout);
    return 0;
  }
  if (!a_.force) check_owners();
  Words folders{"mkdir", "-p"};
  std::string commands;
  for (const Search& search : pipeline_.searches) {
    if (!printed.insert(search.entry).second) continue;
    std::string missing;
    for (const Step& step : search.stages)
      if (!is_whole(step.output)) missing += shell_text(step.command(step.output)) + "\n";
    if (!missing.empty()) folders.push_back(work_.path_of(search.entry));
    commands += missing;
    if (pipeline_.portals_by_frame.empty()) continue;
    for (int64_t k = search.frames.first; k <= search.frames.last; ++k)
      commands +=
          shell_text({"cp", search.found(), name_of_frame("", pipeline_.portals_by_frame, k)}) +
          "\n";
  }
  const std::string entry = work_.path_of(pipeline_.picture_entry);
  if (pipeline_.keeps_film || !pipeline_.portals_by_frame.empty()) folders.push_back(entry);
  if (!pipeline_.filtered.empty())
    folders.push_back(fs::path(pipeline_.noisy).parent_path().string());
  if (folders.size() > 2) commands = shell_text(folders) + "\n" + commands;
  if (is_there(entry + "/film.exr") && !goes_on(pipeline_, entry))
    commands += shell_text({"rm", "-f", entry + "/film.exr"}) + "\n";  // of another picture
  if (pipeline_.filtered.empty())
    commands += shell_text(pipeline_.render.command(request_.picture)) + "\n";
  const std::vector<FilteredFrame> missing = missing_frames();
  if (!missing.empty())
    for (const FrameRange& run : with_those_beside(missing, frame_range(a_.shot)))
      commands += shell_text(command_for(pipeline_.render, run)) + "\n";
  for (const FilteredFrame& frame : missing) {
    Words words = frame.command;
    words.insert(words.end(), {"-o", frame.picture});
    if (!a_.preview.empty()) words.emplace_back("--preview");
    if (a_.exposure) words.push_back(fmt::format("--exposure={}", *a_.exposure));
    commands += shell_text(words) + "\n";
  }
  std::fputs(commands.c_str(), stdout);
  return 0;
}

}  // namespace tdpt
