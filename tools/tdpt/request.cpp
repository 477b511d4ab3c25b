#include "tools/tdpt/request.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "tools/tdpt/shot_report.h"

namespace tdpt {
namespace {

using Names = std::span<const std::string_view>;

// Of the sections of --help with cameras and animations, what is for the renderer alone.
constexpr std::string_view kLens[]{"--f-stop", "--focus", "--shutter"};
constexpr std::string_view kShot[]{"--frames", "--fps"};
constexpr std::string_view kSampling[]{"--seed", "--quality"};
constexpr std::string_view kUnshaped[]{"--threads", "--max-memory", "--quiet", "--explain"};
// Of the filter of frames: its options, those that it makes needless, those that this program
// obeys.
constexpr std::string_view kFilter[]{"--denoiser", "--set pixels", "--set compression"};
constexpr std::string_view kFiltered[]{"--denoise", "--aov", "--preview", "--exposure", "--stats"};
constexpr const char* kFilterChannels = "halves,albedo,normal,depth";
// Options of this program alone.
constexpr std::string_view kOwn[]{"--output",
                                  "--work",
                                  "--work-size",
                                  "--force",
                                  "--report",
                                  "--dry-run",
                                  "--clean",
                                  "--set progress",
                                  "--portal",
                                  "--set dependencies",
                                  "--set dependencies-target"};

bool is_one_of(Names names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Whether it says where the camera is, for which portals are found.
bool places_camera(const cli::Given& given) {
  return given.part == cli::Part::camera && !is_one_of(kLens, given.name);
}

// A value that begins with a dash is joined by "=", lest it look like an option.
void append(Words& words, const cli::Given& given) {
  if (given.values.empty()) words.push_back(given.name);
  for (const std::string& value : given.values) {
    if (given.name.starts_with("--set ")) {
      words.insert(words.end(), {"--set", given.name.substr(6) + "=" + value});
    } else if (value.starts_with('-')) {
      words.push_back(given.name + "=" + value);
    } else {
      words.push_back(given.name);
      words.push_back(value);
    }
  }
}

Words words_in(const char* variable) {
  Words words;
  const char* text = std::getenv(variable);
  for (std::string_view left = text ? text : ""; !left.empty();) {
    const size_t end = std::min(left.find_first_of(" \t\n"), left.size());
    if (end > 0) words.emplace_back(left.substr(0, end));
    left.remove_prefix(std::min(end + 1, left.size()));
  }
  return words;
}

// The camera's options, with the cameras of all views.
Words words_of_all(const Arguments& a, const cli::Common& common) {
  Words words;
  for (cli::Given given : common.given) {
    if (!places_camera(given)) continue;
    if (given.name == "--camera") given.values = a.views;
    append(words, given);
  }
  return words;
}

}  // namespace

bool asks_for_portals(const std::string& output) {
  return output.ends_with(".glb");
}

namespace {

// Throws UsageError for what belongs to a picture.
void check_is_of_portals(const Arguments& a, const Request& r) {
  std::string option;
  for (const Words* words : {&r.render, &r.amount, &r.beside})
    if (!words->empty())
      option = words->front() == "--set" ? "--set " + (*words)[1] : words->front();
  if (!a.portals.empty()) option = "--portal";
  if (!a.report.empty()) option = "--report";
  if (r.is_shot) option = "--frames";
  if (!option.empty())
    throw UsageError(fmt::format("{}: is for a picture, -o {} for portals", option, r.picture));
}

}  // namespace

Request request_of(const Arguments& a, const cli::Common& common) {
  if (a.scene.empty()) throw UsageError("no scene is given; 'tdpt --help' tells how");
  if (a.scene == "-") throw UsageError("-: the scene is read more than once, name its file");
  if (!common.output_given)
    throw UsageError("-o is missing: the picture to write; 'tdpt --help' tells how");
  if (common.output == "-")
    throw UsageError(
        "-o -: the picture is read again, name a file in the place of standard output");
  if (!common.output.ends_with(".exr") && !asks_for_portals(common.output))
    throw UsageError("-o " + common.output +
                     ": the picture is OpenEXR, name it .exr (or .glb for the portals alone)");
  std::error_code ignored;
  if (std::filesystem::exists(common.output, ignored) &&
      !std::filesystem::is_regular_file(common.output, ignored))
    throw OutputError(common.output, "is no regular file, expected one or none");
  if (!a.resume.empty() && a.resume != a.checkpoint && !std::filesystem::exists(a.resume, ignored))
    throw InputError(a.resume, "", "is not there to go on from");
  if (a.add_samples > 0 && a.resume.empty())
    throw UsageError("--add-samples: needs --resume with the film of the picture");
  Request r;
  r.scene = a.scene.starts_with('-') ? "./" + a.scene : a.scene;
  r.picture = common.output;
  const bool filters = filters_frames(a);
  for (const cli::Given& given : common.given) {
    const std::string& name = given.name;
    // --portal goes to the renderer after the scene.
    if (is_one_of(kOwn, name) || (filters && is_one_of(kFiltered, name))) continue;
    append(filters && is_one_of(kFilter, name)    ? r.filter
           : is_one_of(kUnshaped, name)           ? r.unshaped
           : places_camera(given)                 ? r.camera
           : is_one_of(kShot, name)               ? r.shot
           : given.part == cli::Part::animation   ? r.pose
           : given.part == cli::Part::light       ? r.sky
           : name == "--device"                   ? r.device
           : is_one_of(kSampling, name)           ? r.sampling
           : name == "--no-provenance"            ? r.all
           : given.effect == cli::Effect::picture ? r.render
           : given.effect <= cli::Effect::stored  ? r.amount
                                                  : r.beside,
           given);
  }
  if (filters)
    r.amount.insert(r.amount.end(), {"--aov", (a.aov.empty()    ? ""
                                               : a.aov == "all" ? a.aov
                                                                : a.aov + ",") +
                                                  (a.aov == "all" ? "" : kFilterChannels)});
  r.is_shot = a.shot.is_given();
  if (r.is_shot) r.stats = a.stats;
  if (r.is_shot && !a.report.empty() && a.stats.empty()) {
    r.stats = stats_beside(r.picture);
    if (!filters) r.beside.insert(r.beside.end(), {"--stats", r.stats});
  }
  if (asks_for_portals(r.picture)) check_is_of_portals(a, r);
  r.cameras = r.camera;
  if (!a.views.empty()) r.cameras = words_of_all(a, common);
  size_t stage = 0;
  for (const char* variable :
       {"FFGRAPH_FLAGS", "MINCUT_FLAGS", "LIGHTGRID_FLAGS", "PORTALFIT_FLAGS"})
    r.stage_flags[stage++] = words_in(variable);
  return r;
}

bool filters_frames(const RenderArguments& a) {
  return a.shot.is_given() && a.filters() && a.denoiser != kDenoisers.back();
}

bool uses_portals(const Arguments& a, bool scene_has_sky) {
  if (a.integrator == "pt") return false;
  if (a.integrator != "nee" && a.integrator != "bdpt") return true;
  return scene_has_sky || !a.sky.environment.empty() || a.sky.sun_angle > 0;  // through windows
}

}  // namespace tdpt
