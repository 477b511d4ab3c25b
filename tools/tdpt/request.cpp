#include "tools/tdpt/request.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <span>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"

namespace tdpt {
namespace {

// Of the sections of --help with cameras and animations, what is for the renderer alone.
constexpr std::string_view kRenderer[]{"--f-stop", "--focus", "--shutter", "--frames", "--fps"};
constexpr std::string_view kSampling[]{"--seed", "--quality"};
constexpr std::string_view kRunning[]{"--threads", "--max-memory", "--quiet", "--explain"};
// Those that the filter of frames makes needless for the renderer.
constexpr std::string_view kFiltered[]{"--denoise", "--aov", "--preview", "--exposure"};
constexpr const char* kFilterChannels = "halves,albedo,normal,depth";
// Options of this program alone; --portal goes to the renderer after the scene.
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

bool is_one_of(std::span<const std::string_view> names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// The options of the same programs; null: the renderer's alone.
Words* group_of(Request& r, const cli::Given& given) {
  return is_one_of(kRunning, given.name)      ? &r.running
         : is_one_of(kSampling, given.name)   ? &r.sampling
         : is_one_of(kRenderer, given.name)   ? nullptr
         : given.part == cli::Part::camera    ? &r.camera
         : given.part == cli::Part::animation ? &r.pose
         : given.part == cli::Part::light     ? &r.sky
         : given.name == "--device"           ? &r.device
         : given.name == "--no-provenance"    ? &r.stored
                                              : nullptr;
}

// A value that begins with a dash is joined by "=", lest it look like an option.
void append_option(Words& words, const cli::Given& given) {
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
  const char* text = std::getenv(variable);
  std::istringstream stream(text ? text : "");
  return {std::istream_iterator<std::string>(stream), {}};
}

// Throws UsageError for what no program can find out, or would find out late.
void check_files(const Arguments& a, const cli::Common& common) {
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
  if (a.shot.is_given() && !a.report.empty())
    throw UsageError("--report: is for one picture, not for --frames");
}

}  // namespace

bool asks_for_portals(const std::string& output) {
  return output.ends_with(".glb");
}

Request request_of(const Arguments& a, const cli::Common& common) {
  check_files(a, common);
  Request r;
  r.scene = a.scene.starts_with('-') ? "./" + a.scene : a.scene;
  r.picture = common.output;
  const bool filters = filters_frames(a);
  std::string of_picture = !a.portals.empty()  ? "--portal"
                           : !a.report.empty() ? "--report"
                                               : "";  // an option that portals do not take
  for (cli::Given given : common.given) {
    if (is_one_of(kOwn, given.name)) continue;
    Words* const group = group_of(r, given);
    if (group) append_option(*group, given);
    if (!group) of_picture = given.name;
    if (filters && given.name == "--denoiser")
      append_option(r.filter, given);
    else if (!filters || !is_one_of(kFiltered, given.name))
      append_option(r.render, given);
    if (given.name == "--camera" && !a.views.empty()) given.values = a.views;
    if (group == &r.camera) append_option(r.cameras, given);
  }
  if (asks_for_portals(r.picture) && !of_picture.empty())
    throw UsageError(fmt::format("{}: is for a picture, -o {} for portals", of_picture, r.picture));
  if (filters)
    append(
        r.render,
        {"--aov", a.aov == "all" ? a.aov : a.aov + (a.aov.empty() ? "" : ",") + kFilterChannels});
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

// ---- Several cameras ----

namespace {

constexpr std::string_view kNamesOfFiles[]{"--checkpoint", "--resume", "--stats", "--set nonzero"};

// Whether --camera may select several cameras; else its value is the name of one.
bool may_be_several(const std::vector<std::string>& given) {
  return given.size() > 1 ||
         (given.size() == 1 && (given[0] == "all" || given[0].find(',') != given[0].npos));
}

// The cameras that are asked for, once each. The scene is read where the words alone do not tell.
std::vector<std::string> cameras_of(const Arguments& a) {
  if (!may_be_several(a.camera.names)) return a.camera.names;
  const Scene scene = read_gltf(a.scene);
  std::vector<std::string> cameras = names_of_cameras(scene, a.camera.names);
  if (cameras.empty()) scene.camera("");                           // throws
  for (const std::string& camera : cameras) scene.camera(camera);  // throws where there is none
  return cameras;
}

// A camera's name as part of a file's: without what separates folders or is special somewhere, as #
// in the names of frames.
std::string file_name_of(const std::string& camera) {
  std::string name = camera;
  for (char& c : name)
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7f ||
        std::string_view("/\\:*?\"<>|#").find(c) != std::string_view::npos)
      c = '_';
  return name.empty() ? "camera" : name;
}

// The files of one of several cameras, each with its name.
void name_files(View& view, const std::string& name, bool several) {
  const auto rename = [&](const std::string& option, std::string& path) {
    if (several && path.find('%') == path.npos)
      throw UsageError(
          fmt::format("{} {}: there are several cameras; write % where their names are to stand",
                      option, path));
    path = replaced(path, "%", name);
  };
  rename("-o", view.common.output);
  for (cli::Given& given : view.common.given)
    if (is_one_of(kNamesOfFiles, given.name))
      for (std::string& path : given.values) rename(given.name, path);
  Arguments& a = view.arguments;
  for (std::string* const path : {&view.common.dependencies, &a.preview, &a.report, &a.stats,
                                  &a.nonzero, &a.checkpoint, &a.resume})
    *path = replaced(*path, "%", name);
  for (cli::NamedFile& file : view.common.outputs) file.path = replaced(file.path, "%", name);
}

}  // namespace

std::vector<View> views_of(const Arguments& a, const cli::Common& common) {
  std::vector<std::string> cameras;
  if (!a.scene.empty() && common.output_given) cameras = cameras_of(a);
  const bool several = cameras.size() > 1, are_portals = asks_for_portals(common.output);
  if (several && a.shot.is_given()) throw UsageError("--frames: a shot is for one camera");
  if (several && !common.dependencies.empty())
    throw UsageError("--set dependencies: is for the picture of one camera");
  if (several && are_portals && common.output.find('%') != common.output.npos)
    throw UsageError(fmt::format(
        "-o {}: the portals of several cameras are one file, which has no camera's name",
        common.output));
  std::vector<View> views;
  std::set<std::string> pictures;
  for (const std::string& camera : cameras) {
    View& view = views.emplace_back(View{a, common});
    view.arguments.camera.names = {camera};
    if (several) view.arguments.views = cameras;
    for (cli::Given& given : view.common.given)
      if (given.name == "--camera") given.values = {camera};
    if (several && are_portals) break;  // one file for all
    name_files(view, file_name_of(camera), several);
    if (!pictures.insert(view.common.output).second)
      throw UsageError(
          fmt::format("-o {}: {} would be the picture of two cameras, one of them \"{}\"",
                      common.output, view.common.output, camera));
  }
  if (views.empty()) views.push_back({a, common});
  return views;
}

}  // namespace tdpt
