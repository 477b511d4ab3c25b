#include "tools/tdpt/views.h"

#include <algorithm>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/options/shot_options.h"

namespace tdpt {
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

// `path` with the camera's name for each %.
std::string named(const std::string& path, const std::string& name) {
  std::string out;
  for (const char c : path) out += c == '%' ? name : std::string(1, c);
  return out;
}

// The files of several cameras would be one.
void check_has_place_for_name(const std::string& option, const std::string& path) {
  if (path.find('%') == path.npos)
    throw UsageError(fmt::format(
        "{} {}: there are several cameras; write % where their names are to stand", option, path));
}

View view_of(const Arguments& a, const cli::Common& common, const std::string& camera,
             const std::vector<std::string>& all) {
  View view{a, common};
  const bool several = all.size() > 1;
  const std::string name = file_name_of(camera);
  view.arguments.camera.names = {camera};
  if (several) view.arguments.views = all;
  if (several) check_has_place_for_name("-o", common.output);
  for (cli::Given& given : view.common.given) {
    if (given.name == "--camera") given.values = {camera};
    if (std::find(std::begin(kNamesOfFiles), std::end(kNamesOfFiles), given.name) ==
        std::end(kNamesOfFiles))
      continue;
    for (std::string& path : given.values) {
      if (several) check_has_place_for_name(given.name, path);
      path = named(path, name);
    }
  }
  for (std::string* const path :
       {&view.common.output, &view.common.dependencies, &view.arguments.preview,
        &view.arguments.report, &view.arguments.stats, &view.arguments.nonzero,
        &view.arguments.checkpoint, &view.arguments.resume})
    *path = named(*path, name);
  for (cli::NamedFile& file : view.common.outputs) file.path = named(file.path, name);
  return view;
}

// The portals of all cameras are one file.
View view_of_all(const Arguments& a, const cli::Common& common,
                 const std::vector<std::string>& all) {
  if (common.output.find('%') != common.output.npos)
    throw UsageError(fmt::format(
        "-o {}: the portals of several cameras are one file, which has no camera's name",
        common.output));
  View view{a, common};
  view.arguments.camera.names = {all[0]};
  view.arguments.views = all;
  for (cli::Given& given : view.common.given)
    if (given.name == "--camera") given.values = {all[0]};
  return view;
}

// The files of a shot have a number each.
void check_frames(const Arguments& a, const cli::Common& common) {
  check_shot(a.shot, a.pose);
  const std::string none;
  for (const auto& [option, path] : {std::pair("-o", common.output_given ? &common.output : &none),
                                     {"--preview", &a.preview},
                                     {"--stats", &a.stats},
                                     {"--set nonzero", &a.nonzero},
                                     {"--checkpoint", &a.checkpoint},
                                     {"--resume", &a.resume}})
    if (!path->empty()) name_of_frame(option, *path, 0);
}

}  // namespace

std::vector<View> views_of(const Arguments& a, const cli::Common& common) {
  std::vector<std::string> cameras;
  if (!a.scene.empty()) cameras = cameras_of(a);
  if (cameras.size() > 1 && a.shot.is_given())
    throw UsageError("--frames: a shot is for one camera");
  if (cameras.size() > 1 && !common.dependencies.empty())
    throw UsageError("--set dependencies: is for the picture of one camera");
  if (cameras.size() > 1 && asks_for_portals(common.output))
    return {view_of_all(a, common, cameras)};
  if (!common.output_given) cameras.clear();
  std::vector<View> views;
  std::set<std::string> pictures;
  for (const std::string& camera : cameras) {
    views.push_back(view_of(a, common, camera, cameras));
    const std::string& picture = views.back().common.output;
    if (!pictures.insert(picture).second)
      throw UsageError(
          fmt::format("-o {}: {} would be the picture of two cameras, one of them \"{}\"",
                      common.output, picture, camera));
  }
  if (views.empty()) views.push_back({a, common});
  if (a.shot.is_given()) check_frames(views[0].arguments, views[0].common);
  return views;
}

}  // namespace tdpt
