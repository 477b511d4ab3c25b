#include "tools/tdpt/making.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <unistd.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/process.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/outputs.h"
#include "libcommon/film/film_file.h"
#include "libcommon/formats/tone.h"
#include "libcommon/options/picture_options.h"
#include "tools/tdpt/pipeline.h"
#include "tools/tdpt/session.h"

namespace tdpt {
namespace {

namespace fs = std::filesystem;

constexpr int kStopped = static_cast<int>(Exit::interrupted);

bool exists(const std::string& path) {
  std::error_code failed;
  return fs::exists(path, failed);
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

// Absolute, even if the current folder no longer exists.
std::string full_path(const std::string& path) {
  std::error_code failed;
  const fs::path full = fs::absolute(path, failed);
  return failed ? path : full.string();
}

// Whether a frame of a shot may take the place of this file: it is one that tdpt-render marked.
bool may_be_replaced(const std::string& path) {
  if (!exists(path)) return true;
  try {
    return read_exr(path).attributes.contains(kFrameAttribute);
  } catch (const InputError&) {
    return false;
  }
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
        pipeline(pipeline_of(a, common, request, state, cache)) {
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
    return {a.report, fmt::format("{} report {} {} {}", pipeline.key, variable("REPORT_TIME"),
                                  variable("REPORT_REFERENCE"), variable("REPORT_WIDTH"))};
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
  /// Whether the stage need not run: for a report its own is there, too.
  bool is_done(const Step& stage) const {
    return exists(stage.output) && (a.report.empty() || exists(stage.output + ".told.txt"));
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
    if (!a.shot.is_given()) {
      const std::string hash = hash_at(request.picture);
      if (hash.empty() || cache.knows(hash, "")) return;
      throw UsageError(request.picture +
                       ": is there already, and tdpt did not make it; --force replaces it");
    }
    const FrameRange range = frame_range(a.shot);
    for (int64_t k = range.first; k <= range.last; ++k)
      if (const std::string path = name_of_frame("-o", request.picture, k); !may_be_replaced(path))
        throw UsageError(path +
                         ": is there already, and is no frame of a shot; --force replaces it");
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
  const Request request;
  const Cache cache;
  const SceneState state;
  const Pipeline pipeline;
};

// The number of programs that are to run; `made`: the picture is there, and its report is not.
size_t steps_of(const Plan& plan, bool made) {
  size_t steps = 1 + !made + !plan.a.report.empty() + !plan.pipeline.filtered.empty();
  for (const Search& search : plan.pipeline.searches)
    for (const Step& stage : search.stages) steps += !plan.is_done(stage);
  return steps;
}

void begin_step(const Plan& plan, Session& session, const std::string& title,
                const std::string& program) {
  session.begin_step(title, program, plan.a.views.empty() ? "" : plan.request.picture);
}

// The command of a first preview, which is rendered without portals while they are sought.
Words preview_command(const Plan& plan) {
  const Arguments& a = plan.a;
  const Request& r = plan.request;
  Words words{program_folder() + "/tdpt-render", r.scene};
  for (const Words* more : {&r.camera, &r.pose, &r.sky, &r.running}) append(words, *more);
  append(words, {"--integrator", "bdpt", "--spp", "256", "--quiet", "--preview"});
  if (a.width > 0) append(words, {"--width", std::to_string(a.width)});
  if (a.height > 0) append(words, {"--height", std::to_string(a.height)});
  append(words, exposure_words(a));
  return words;
}

// A result gets its name in the cache when it is whole: lightgrid writes what it has when it is
// stopped, too.
void run_stage(const Plan& plan, Session& session, const Search& search, const Step& stage) {
  session.begin_step(stage.title, stage.options[0], "");  // of all pictures
  if (!plan.a.preview.empty() && !plan.a.shot.is_given() && !session.has_first_preview())
    session.begin_first_preview(preview_command(plan));
  const std::string made = session.path_of(fs::path(stage.output).filename().string());
  Words words = stage.command(made);
  if (words[0].ends_with("/lightgrid"))  // the others are short and report no progress
    append(words, {"--set", "progress=json"});
  const bool reads_scene = stage.inputs[0] == plan.request.scene, explains = !plan.a.report.empty();
  ChildProcess::How how;
  std::string explained;
  if (explains) {
    how.stdout_file = stage.output + ".told.json";
    const bool is_plan = stage.output.ends_with(".portal.glb");  // it has words to read
    append(words, {"--json", "--explain", "--preview",
                   stage.output + (is_plan ? ".told.svg" : ".told.png")});
    if (!reads_scene) append(words, {"--scene", plan.request.scene});
    if (!reads_scene) append(words, plan.request.pose);
  }
  const int code = session.run(words, how, explains ? &explained : nullptr);
  if (reads_scene && code != kStopped && plan.has_changed()) {
    fs::remove_all(plan.cache.path_of(search.entry));  // it is of another scene than its key says
    throw InputError(plan.request.scene, "", "has changed while tdpt was at work; start it again");
  }
  if (code != 0) throw ProgramEnded{code};
  fs::rename(made, stage.output);
  if (explains) write_output(stage.output + ".told.txt", explained);
}

void find_portals(const Plan& plan, Session& session) {
  if (!plan.state.drawn.empty())
    plan.common.note("renders with " + plan.state.drawn +
                     ", which lies beside the scene: no others are searched for");
  for (const Search& search : plan.pipeline.searches) {
    plan.cache.use(search.entry);
    for (const Step& stage : search.stages)
      if (!plan.is_done(stage)) run_stage(plan, session, search, stage);
    if (plan.pipeline.portals_by_frame.empty()) continue;
    const std::string bytes = read_file(search.found());
    for (int64_t k = search.frames.first; k <= search.frames.last; ++k)
      write_output(name_of_frame("", plan.pipeline.portals_by_frame, k), bytes);
  }
  session.end_first_preview();
}

// Gives the picture its name. Its maker is recorded before, so that it is known however this
// process ends.
void place_picture(const Plan& plan, Session& session, const std::string& made, bool whole) {
  session.publish_preview();
  const bool of_another = whole && plan.has_changed();
  if (of_another)
    plan.common.note(plan.request.scene +
                     " has changed while tdpt was at work; the same command renders it");
  try {
    if (whole && !of_another)
      for (const Plan::Result& result : plan.rendered(made)) plan.know(result);
    else
      plan.know({made, "of no command"});
  } catch (const OutputError& e) {
    plan.common.warn(std::string(e.what()) + "; tdpt will not know that it made the picture");
  }
  write_output(plan.request.picture, read_file(made));
  plan.know(plan.preview());
  if (!whole) plan.common.note(plan.request.picture + " has what was rendered until then");
}

void render(const Plan& plan, Session& session) {
  const Pipeline& pipeline = plan.pipeline;
  begin_step(plan, session, "rendering", pipeline.render.options[0]);
  const std::string made = session.path_of("picture.exr");
  const std::string& film = pipeline.film;
  Words words = pipeline.render.command(made);
  if (!asks_for_portals(plan.request.picture)) append(words, {"--set", "progress=json"});
  const ChildProcess::How how{true, "", 0};
  std::error_code ignored;
  const bool goes_on = exists(film);
  int code = session.run(words, how);
  if (goes_on &&
      (code == static_cast<int>(Exit::bad_input) || code == static_cast<int>(Exit::usage))) {
    plan.common.note("what the run before left cannot be used; begins with the first sample");
    fs::remove(film, ignored);
    code = session.run(words, how);
  }
  if (code == 0 || (code == kStopped && exists(made)))
    place_picture(plan, session, made, code == 0);
  if (code != 0) throw ProgramEnded{code};
  if (film == pipeline.shared_film || !exists(film)) return;
  plan.cache.use(fs::path(pipeline.shared_film).parent_path().filename().string());
  if (!exists(pipeline.shared_film)) fs::rename(film, pipeline.shared_film, ignored);
  fs::remove_all(plan.cache.path_of(pipeline.entry), ignored);
}

// A frame's maker is recorded before it gets its name, as that of a picture.
void filter_frames(const Plan& plan, Session& session) {
  const Arguments& a = plan.a;
  begin_step(plan, session, "filtering frames", "exrdenoise");
  const std::string made = session.path_of("frame.exr");
  const std::vector<FilteredFrame> missing = plan.missing_frames();
  if (const size_t there = plan.pipeline.filtered.size() - missing.size(); there > 0)
    plan.common.note(counted(there, "filtered frame") + (there == 1 ? " is" : " are") +
                     " there already");
  for (const FilteredFrame& frame : missing) {
    Words words = frame.command;
    append(words, {"-o", made});
    session.need(words);
    plan.know({made, frame.key});
    write_output(frame.picture, read_file(made));
  }
  if (a.preview.empty()) return;
  // Previews of one exposure do not flicker.
  std::optional<double> exposure = a.exposure;
  for (const FilteredFrame& frame : plan.pipeline.filtered) {
    const Picture picture = read_exr(frame.picture).picture;
    if (!exposure) {
      exposure = auto_exposure(picture);
      plan.common.note(fmt::format("previews are exposed as frame {}: --exposure {}", frame.number,
                                   number_words(*exposure)));
    }
    write_output(name_of_frame("--preview", a.preview, frame.number),
                 preview_bytes(picture, *exposure));
  }
}

// The renderer writes each frame when it is whole, and renders none again that is.
void render_frames(const Plan& plan, Session& session) {
  const Pipeline& pipeline = plan.pipeline;
  begin_step(plan, session, "rendering frames", pipeline.render.options[0]);
  std::vector<FrameRange> runs{frame_range(plan.a.shot)};
  if (!pipeline.filtered.empty()) {
    runs = with_those_beside(plan.missing_frames(), runs[0]);
    fs::create_directories(pipeline.noisy);
  }
  for (const FrameRange& run : runs) {
    Words words = command_for(pipeline.render, run);
    append(words, {"--set", "progress=json"});
    session.need(words, {true, "", 0});
  }
  if (!pipeline.filtered.empty()) filter_frames(plan, session);
  std::error_code ignored;
  fs::remove_all(plan.cache.path_of(pipeline.entry), ignored);
}

void make_report(const Plan& plan, Session& session) {
  const std::string page = session.path_of("report.html"),
                    script = program_folder() + "/../share/tdpt/report_measure.py";
  const Step& rendering = plan.pipeline.render;
  begin_step(plan, session, "making the report", "python3");
  Words words{"python3", "-B", script, "--scene", plan.request.scene};
  append(words, {"--folder", session.path_of("report"), "--page", page, "--progress"});
  if (!plan.pipeline.searches.empty())
    append(words, {"--stem", plan.cache.path_of(plan.pipeline.searches[0].entry) + "/scene"});
  if (plan.common.quiet) words.emplace_back("--quiet");
  words.emplace_back("--");
  append(words, rendering.options);
  append(words, Words(rendering.inputs.begin() + 1, rendering.inputs.end()));
  session.need(words);
  write_output(plan.a.report, read_file(page));
  plan.know(plan.report());
}

// Runs what is needed. `made`: the picture is there, and its report is not.
void run_programs(const Plan& plan, Session& session, bool made) {
  // What can be checked before the first stage: the renderer's options, its files, its device.
  begin_step(plan, session, "reading the scene", "tdpt-render");
  if (!plan.a.report.empty() && session.run({"python3", "-c", ""}) != 0)
    throw UsageError("--report: needs python3");
  session.need(plan.pipeline.check);
  find_portals(plan, session);
  if (!made && plan.a.shot.is_given()) render_frames(plan, session);
  if (!made && !plan.a.shot.is_given()) render(plan, session);
  if (!plan.a.report.empty()) make_report(plan, session);
}

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
    const std::string& entry = plan.pipeline.entry;
    const std::string in_use = entry.empty() ? "" : plan.cache.use(entry);
    Session session(
        plan.cache.use(fmt::format("run-{}-{}", ::getpid(),
                                   std::chrono::system_clock::now().time_since_epoch().count())),
        in_use, a.preview, steps_of(plan, made), common.quiet);
    try {
      run_programs(plan, session, made);
      std::string files = made ? "" : plan.request.picture;
      for (const std::string& path : {a.preview, a.stats, a.nonzero, a.report})
        if (!path.empty() && exists(path)) files += (files.empty() ? "" : ", ") + path;
      common.note("wrote " + files);
    } catch (const ProgramEnded& ended) {
      code = ended.code;
      if (code == kStopped)
        common.note("stopped while " + session.title() + "; the same command goes on");
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
      add({program_folder() + "/exrmerge", request.picture, "-o", a.preview}, exposure_words(a));
    return commands;
  }
  plan.check_owners();
  const auto make_folder = [&](const std::string& path) { add({"mkdir", "-p", path}); };
  if (!pipeline.film.empty() || !pipeline.portals_by_frame.empty())
    make_folder(plan.cache.path_of(pipeline.entry));
  if (!pipeline.filtered.empty()) make_folder(pipeline.noisy);
  for (const Search& search : pipeline.searches) {
    if (!printed.insert(search.entry).second) continue;
    if (!exists(search.found())) make_folder(plan.cache.path_of(search.entry));
    for (const Step& step : search.stages)
      if (!exists(step.output)) add(step.command(step.output));
    if (pipeline.portals_by_frame.empty()) continue;
    for (int64_t k = search.frames.first; k <= search.frames.last; ++k)
      add({"cp", search.found(), name_of_frame("", pipeline.portals_by_frame, k)});
  }
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
