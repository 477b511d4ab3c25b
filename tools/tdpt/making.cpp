#include "tools/tdpt/making.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "libcommon/base/child_process.h"
#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/process.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/outputs.h"
#include "libcommon/formats/tone.h"
#include "libcommon/options/picture_options.h"
#include "tools/tdpt/conversation.h"
#include "tools/tdpt/pipeline.h"
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

Words exposure_words(const Arguments& a) {
  return a.exposure ? Words{fmt::format("--exposure={}", *a.exposure)} : Words{};
}

// What a request comes to before a program runs, and which of it is there.
struct Plan {
  Plan(const Arguments& arguments, const cli::Common& given)
      : a(arguments),
        common(given),
        request(request_of(a, common)),
        cache(full_path(a.work.empty() ? Cache::usual_path() : a.work)),
        state(state_of(a)),
        pipeline(pipeline_of(a, common, request, state, cache, programs)) {
    common.also_read(state.files);
  }

  /// A file that a command makes, and the key of its bytes; no path: it is not asked for.
  struct Result {
    std::string path, key;
  };
  Result preview() const {
    return {a.preview, "preview of " + hash_at(request.picture) + shell_text(exposure_words(a))};
  }
  Result report() const {
    return {a.report,
            fmt::format("{} report {} {} {}", pipeline.key, variable("REPORT_TIME", "10"),
                        variable("REPORT_REFERENCE", "8"), variable("REPORT_WIDTH", "320"))};
  }
  /// The picture and all that its rendering writes. A preview can be made of the picture.
  std::vector<Result> rendered(const std::string& picture) const {
    return {{picture, pipeline.key},
            {a.stats, pipeline.key + " stats"},
            {a.nonzero, pipeline.key + " nonzero"}};
  }

  bool is_there(const Result& result) const {
    return result.path.empty() || cache.knows(hash_at(result.path), result.key);
  }
  bool is_fresh() const {
    const std::vector<Result> all = rendered(request.picture);
    return pipeline.repeatable &&
           std::all_of(all.begin(), all.end(), [&](const Result& r) { return is_there(r); });
  }
  void know(const Result& result) const {
    if (const std::string hash = hash_at(result.path); !hash.empty()) cache.know(hash, result.key);
  }
  bool explains_stages() const { return !a.report.empty() && !request.is_shot; }
  /// Whether the stage need not run: for a report its own is there, too.
  bool is_done(const Step& stage) const {
    return exists(stage.output) && (!explains_stages() || exists(stage.output + ".told.txt"));
  }
  /// Frames that are to be filtered and are not there as they would be.
  std::vector<FilteredFrame> missing_frames() const {
    std::vector<FilteredFrame> missing;
    for (const FilteredFrame& frame : pipeline.filtered)
      if (!is_there({frame.picture, frame.key})) missing.push_back(frame);
    return missing;
  }

  /// Throws UsageError for files that are not tdpt's to replace.
  void check_owners() const {
    if (a.force) return;
    if (!request.is_shot) {
      const std::string hash = hash_at(request.picture);
      if (hash.empty() || cache.knows(hash, "")) return;
      throw UsageError(request.picture +
                       ": is there already, and tdpt did not make it; --force replaces it");
    }
    const FrameRange range = frame_range(a.shot);
    for (int64_t k = range.first; k <= range.last; ++k) {
      check_is_frame(name_of_frame("-o", request.picture, k));
      if (!request.stats.empty() && a.stats.empty())
        check_is_stats(name_of_frame("--stats", request.stats, k));
    }
  }
  /// Whether the scene's files have, since their hashes were taken.
  bool has_changed() const {
    try {
      return state_of(a) != state;
    } catch (const InputError&) {
      return true;  // it is being replaced
    }
  }

  const Arguments& a;
  const cli::Common& common;
  const std::string programs = program_folder();
  const Request request;
  const Cache cache;
  const SceneState state;
  const Pipeline pipeline;
};

// Runs what a plan needs. Its functions throw Ended with the exit code of a program that failed.
class Run {
 public:
  explicit Run(const Plan& plan)
      : plan_(plan),
        folder_(plan.cache.use(fmt::format(
            "run-{}-{}", ::getpid(), std::chrono::system_clock::now().time_since_epoch().count()))),
        conversation_(plan.common.quiet) {}
  ~Run() {
    look_.reset();
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// `made`: the picture is there, and its report is not.
  void make(bool made) {
    left_ = made ? picture_ + " is whole" : "nothing is rendered yet";
    steps_ = !made + !a_.report.empty() + !pipeline_.filtered.empty();
    for (const Search& search : pipeline_.searches)
      for (const Step& stage : search.stages) steps_ += !plan_.is_done(stage);
    // What can be checked before the first stage: the renderer's options, its files, its device.
    if (!pipeline_.entry.empty()) cache_.use(pipeline_.entry);
    begin_step("reading the scene", "tdpt-render");
    step_ = 0;
    if (!a_.report.empty() && run({"python3", "-c", ""}) != 0)
      throw UsageError("--report: needs python3");
    need(pipeline_.check);
    find_portals();
    if (!made && request_.is_shot) render_frames();
    if (!made && !request_.is_shot) render();
    if (!a_.report.empty()) make_report();
  }

  /// What was done when a signal came, and what there is of the picture.
  std::string stopped() const { return "stopped while " + doing_ + "; " + left_; }

 private:
  void find_portals() {
    doing_ = "looking for portals";
    if (!plan_.state.drawn.empty())
      common_.note("renders with " + plan_.state.drawn +
                   ", which lies beside the scene: no others are searched for");
    for (const Search& search : pipeline_.searches) {
      cache_.use(search.entry);
      for (const Step& stage : search.stages)
        if (!plan_.is_done(stage)) run_stage(search, stage);
      if (pipeline_.portals_by_frame.empty()) continue;
      const std::string bytes = read_file(search.found());
      for (int64_t k = search.frames.first; k <= search.frames.last; ++k)
        write_output(name_of_frame("", pipeline_.portals_by_frame, k), bytes);
    }
    look_.reset();
  }

  // While portals are sought, a first preview is rendered without them.
  void start_preview() {
    Words words{plan_.programs + "/tdpt-render", request_.scene};
    for (const Words* more : {&request_.camera, &request_.pose, &request_.sky, &request_.running})
      append(words, *more);
    append(words, {"--integrator", "bdpt", "--spp", "256", "--quiet", "--preview"});
    if (a_.width > 0) append(words, {"--width", std::to_string(a_.width)});
    if (a_.height > 0) append(words, {"--height", std::to_string(a_.height)});
    append(words, exposure_words(a_));
    append(words, {"-o", folder_ + "/look.exr"});
    look_ = std::make_unique<ChildProcess>(words, ChildProcess::How{false, "", kNice});
  }

  void run_stage(const Search& search, const Step& stage) {
    begin_step(stage.title, stage.options[0], true);
    if (!a_.preview.empty() && !request_.is_shot && !look_) start_preview();
    Words words = stage.command(stage.output);
    if (name_of(words[0]) == "lightgrid")  // the others are short and report no progress
      append(words, {"--set", "progress=json"});
    const bool reads_scene = stage.inputs[0] == request_.scene;
    ChildProcess::How how;
    std::string explained;
    if (plan_.explains_stages()) {
      how.stdout_file = stage.output + ".told.json";
      const bool is_plan = stage.output.ends_with(".portal.glb");  // it has words to read
      append(words, {"--json", "--explain", "--preview",
                     stage.output + (is_plan ? ".told.svg" : ".told.png")});
      if (!reads_scene) append(words, {"--scene", request_.scene});
      if (!reads_scene) append(words, request_.pose);
    }
    const int code = run(words, how, plan_.explains_stages() ? &explained : nullptr);
    if (reads_scene && code != kStopped && plan_.has_changed()) {
      fs::remove_all(cache_.path_of(search.entry));  // it is of another scene than its key says
      throw InputError(request_.scene, "", "has changed while tdpt was at work; start it again");
    }
    if (code != 0) throw Ended{code};
    if (plan_.explains_stages()) write_output(stage.output + ".told.txt", explained);
  }

  // Copies a renderer's preview to its place whenever it has changed.
  void publish(const std::string& preview) {
    std::error_code failed;
    const auto time = fs::last_write_time(preview, failed);
    if (a_.preview.empty() || failed || time == preview_time_) return;
    preview_time_ = time;
    write_output(a_.preview, read_file(preview));
  }

  void render() {
    doing_ = "rendering";
    begin_step(doing_, pipeline_.render.options[0]);
    const std::string made = folder_ + "/picture.exr";
    const std::string& film = pipeline_.film;
    Words words = pipeline_.render.command(made);
    if (!asks_for_portals(picture_)) append(words, {"--set", "progress=json"});
    ChildProcess::How how;
    how.shares_stdout = true;
    const bool goes_on = exists(film);
    int code = run(words, how);
    if (goes_on &&
        (code == static_cast<int>(Exit::bad_input) || code == static_cast<int>(Exit::usage))) {
      common_.note("what the run before left cannot be used; begins with the first sample");
      std::error_code ignored;
      fs::remove(film, ignored);
      code = run(words, how);
    }
    if (code == 0 || (code == kStopped && exists(made))) place(code == 0);
    if (code != 0) throw Ended{code};
    std::error_code ignored;
    if (film != pipeline_.shared_film && exists(film)) {
      cache_.use(name_of(fs::path(pipeline_.shared_film).parent_path()));
      if (!exists(pipeline_.shared_film)) fs::rename(film, pipeline_.shared_film, ignored);
      fs::remove_all(cache_.path_of(pipeline_.entry), ignored);
    }
  }

  // The picture's maker is recorded before the picture gets its name, so that it is known however
  // this process ends.
  void place(bool whole) {
    const std::string made = folder_ + "/picture.exr";
    publish(cli::png_beside(made));
    const bool of_another = whole && plan_.has_changed();
    if (of_another)
      common_.note(request_.scene +
                   " has changed while tdpt was at work; the same command renders it");
    try {
      if (whole && !of_another)
        for (const Plan::Result& result : plan_.rendered(made)) plan_.know(result);
      else
        plan_.know({made, "of no command"});
    } catch (const OutputError& e) {
      common_.warn(std::string(e.what()) + "; tdpt will not know that it made the picture");
    }
    write_output(picture_, read_file(made));
    plan_.know(plan_.preview());
    left_ = picture_ + (whole ? " is whole" : " has what was rendered until then");
  }

  // The renderer writes each frame when it is whole, and renders none again that is.
  void render_frames() {
    doing_ = "rendering";
    left_ = "the frames that are there stay";
    begin_step("rendering frames", pipeline_.render.options[0]);
    ChildProcess::How how;
    how.shares_stdout = true;
    std::vector<FrameRange> runs{frame_range(a_.shot)};
    if (!pipeline_.filtered.empty()) {
      runs = with_those_beside(plan_.missing_frames(), runs[0]);
      fs::create_directories(fs::path(pipeline_.noisy).parent_path());
    }
    for (const FrameRange& run : runs) {
      Words words = command_for(pipeline_.render, run);
      append(words, {"--set", "progress=json"});
      need(words, how);
    }
    if (!pipeline_.filtered.empty()) filter_frames();
    std::error_code ignored;
    fs::remove_all(cache_.path_of(pipeline_.entry), ignored);
  }

  // A frame's maker is recorded before it gets its name, as that of a picture.
  void filter_frames() {
    doing_ = "filtering frames";
    begin_step(doing_, "exrdenoise");
    const std::string made = folder_ + "/frame.exr", summary = folder_ + "/summary.json";
    const std::vector<FilteredFrame> missing = plan_.missing_frames();
    if (const size_t there = pipeline_.filtered.size() - missing.size(); there > 0)
      common_.note(counted(there, "filtered frame") + (there == 1 ? " is" : " are") +
                   " there already");
    for (const FilteredFrame& frame : missing) {
      Words words = frame.command;
      append(words, {"--json", "-o", made});
      ChildProcess::How how;
      how.stdout_file = summary;
      need(words, how);
      plan_.know({made, frame.key});
      write_output(frame.picture, read_file(made));
      if (!request_.stats.empty())
        write_filtered_stats(name_of_frame("", pipeline_.noisy + ".json", frame.number), summary,
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

  void make_report() {
    doing_ = "measuring for the report";
    const std::string scripts = plan_.programs + "/../share/tdpt/", parts = folder_ + "/report";
    const std::string page = folder_ + "/report.html";
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
      append(measure,
             {"--exrdiff", plan_.programs + "/exrdiff", "--info", plan_.programs + "/tdpt-info"});
      if (!pipeline_.searches.empty())
        append(measure, {"--stem", cache_.path_of(pipeline_.searches[0].entry) + "/scene"});
      if (common_.quiet) measure.emplace_back("--quiet");
      append(measure, {"--progress", "--"});
      append(measure, pipeline_.render.options);
      append(measure, Words(pipeline_.render.inputs.begin() + 1, pipeline_.render.inputs.end()));
      need(measure);
    }
    need({"python3", "-B", scripts + (request_.is_shot ? "report_shot.py" : "report_page.py"),
          parts, page});
    write_output(a_.report, read_file(page));
    plan_.know(plan_.report());
  }

  void begin_step(const std::string& title, const std::string& program, bool is_of_all = false) {
    const std::string about = a_.views.empty() || is_of_all ? "" : picture_;
    ++step_;
    conversation_.step(step_, std::max(step_, steps_), about.empty() ? title : title + " " + about,
                       name_of(program), about);
  }

  int run(const Words& words, const ChildProcess::How& how = {}, std::string* explained = nullptr) {
    if (stop_requested()) return kStopped;
    ChildProcess child(words, how);
    std::string text, unheard;
    bool is_stopping = false;
    const auto hear = [&] {
      for (size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1)) {
        const std::string line = text.substr(0, end);
        if (explained && !line.starts_with('{')) *explained += line + "\n";
        if (!explained || line.find(kDecision) == std::string::npos) conversation_.print(line);
      }
    };
    std::error_code ignored;
    while (!child.exit_code()) {
      child.read(text);
      hear();
      if (stop_requested() && !std::exchange(is_stopping, true)) child.send(SIGTERM);
      if (look_) look_->read(unheard);
      try {
        publish(folder_ + (look_ ? "/look.png" : "/picture.png"));
      } catch (const Error&) {  // the final write will report an error
      }
      // A folder that is in use is not old.
      for (const std::string& folder : {folder_, cache_.path_of(pipeline_.entry)})
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

  void need(const Words& words, const ChildProcess::How& how = {}) {
    if (const int code = run(words, how); code != 0) throw Ended{code};
  }

  const Plan& plan_;
  const Arguments& a_ = plan_.a;
  const cli::Common& common_ = plan_.common;
  const Request& request_ = plan_.request;
  const Cache& cache_ = plan_.cache;
  const Pipeline& pipeline_ = plan_.pipeline;
  const std::string& picture_ = request_.picture;
  const std::string folder_;  ///< of files that go when this run ends
  Conversation conversation_;
  std::unique_ptr<ChildProcess> look_;  ///< renders a first preview while portals are sought
  std::string doing_, left_;
  fs::file_time_type preview_time_{};  ///< of the last published preview
  size_t step_ = 0, steps_ = 0;
};

// The preview, of the picture that is there.
void make_preview(const Plan& plan) {
  const Picture picture = read_exr(plan.request.picture).picture;
  const auto exposure = exposure_of(picture, plan.a.preview, plan.a.exposure);
  write_output(plan.a.preview, preview_bytes(picture, *exposure));
  plan.know(plan.preview());
  plan.common.note("wrote " + plan.a.preview);
}

}  // namespace

int make(const Arguments& a, const cli::Common& common) {
  const Plan plan(a, common);
  const bool made = plan.is_fresh();
  if (made && !plan.is_there(plan.preview())) make_preview(plan);
  int code = 0;
  if (made && plan.is_there(plan.report())) {
    common.note(plan.request.picture + " is up to date");
  } else {
    if (!made) plan.check_owners();
    Run run(plan);
    try {
      run.make(made);
      std::string files = made ? "" : plan.request.picture;
      for (const std::string& path : {a.preview, a.stats, a.nonzero, a.report})
        if (!path.empty() && exists(path)) files += (files.empty() ? "" : ", ") + path;
      common.note("wrote " + files);
    } catch (const Ended& ended) {
      code = ended.code;
      if (code == kStopped) common.note(run.stopped() + "; the same command goes on");
    }
  }
  if (code == 0 && !common.dependencies.empty())
    write_output(common.dependencies, common.dependency_rule());
  plan.cache.shrink_to(*parse_size(a.work_size));
  return code;
}

std::string commands_of(const Arguments& a, const cli::Common& common,
                        std::set<std::string>& printed) {
  const Plan plan(a, common);
  const Request& request = plan.request;
  const Pipeline& pipeline = plan.pipeline;
  std::string commands;
  const auto add = [&](Words words, const Words& more = {}) {
    append(words, more);
    commands += shell_text(words) + "\n";
  };
  if (plan.is_fresh()) {
    if (plan.is_there(plan.preview()))
      common.note(request.picture + " is up to date");
    else
      add({plan.programs + "/exrmerge", request.picture, "-o", a.preview}, exposure_words(a));
    return commands;
  }
  plan.check_owners();
  Words folders{"mkdir", "-p"};
  if (!pipeline.film.empty() || !pipeline.portals_by_frame.empty())
    folders.push_back(plan.cache.path_of(pipeline.entry));
  if (!pipeline.filtered.empty())
    folders.push_back(fs::path(pipeline.noisy).parent_path().string());
  for (const Search& search : pipeline.searches) {
    if (!printed.insert(search.entry).second) continue;
    if (!exists(search.found())) folders.push_back(plan.cache.path_of(search.entry));
    for (const Step& step : search.stages)
      if (!exists(step.output)) add(step.command(step.output));
    if (pipeline.portals_by_frame.empty()) continue;
    for (int64_t k = search.frames.first; k <= search.frames.last; ++k)
      add({"cp", search.found(), name_of_frame("", pipeline.portals_by_frame, k)});
  }
  if (folders.size() > 2) commands = shell_text(folders) + "\n" + commands;
  if (pipeline.filtered.empty()) add(pipeline.render.command(request.picture));
  const std::vector<FilteredFrame> missing = plan.missing_frames();
  if (!missing.empty())
    for (const FrameRange& run : with_those_beside(missing, frame_range(a.shot)))
      add(command_for(pipeline.render, run));
  for (const FilteredFrame& frame : missing) {
    Words words = frame.command;
    append(words, {"-o", frame.picture});
    if (!a.preview.empty()) words.emplace_back("--preview");
    add(words, exposure_words(a));
  }
  return commands;
}

}  // namespace tdpt
