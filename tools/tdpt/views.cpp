#include "tools/tdpt/views.h"

#include <algorithm>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/formats/shot_options.h"

namespace tdpt {
namespace {

constexpr std::string_view kNamesOfFiles[]{"--checkpoint", "--resume", "--stats", "--set nonzero"};

// Whether --camera may select several cameras; else its value is the name of one.
bool may_be_several(const std::vector<std::string>& given) {
  return given.size() > 1 ||
         (given.size() == 1 && (given[0] == "all" || given[0].find(',') != given[0].npos));
}

// A camera's name as part of a file's: without what separates folders or is special somewhere.
std::string file_name_of(const std::string& camera) {
  std::string name = camera;
  for (char& c : name)
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7f ||
        std::string_view("/\\:*?\"<>|").find(c) != std::string_view::npos)
      c = '_';
  return name.empty() ? "camera" : name;
}

// `path` with the camera's name for each %; without % it would be the file of all cameras.
std::string named(const std::string& option, const std::string& path, const std::string& name) {
  if (path.find('%') == path.npos)
    throw UsageError(fmt::format(
        "{} {}: there are several cameras; write % where their names are to stand", option, path));
  std::string out;
  for (const char c : path) out += c == '%' ? name : std::string(1, c);
  return out;
}

View view_of(const Arguments& a, const cli::Common& common, const std::string& camera,
             const std::vector<std::string>& all) {
  View view{a, common};
  const std::string name = file_name_of(camera);
  view.arguments.camera.names = {camera};
  view.arguments.views = all;
  view.common.output = named("-o", common.output, name);
  for (cli::Given& given : view.common.given) {
    if (given.name == "--camera") given.values = {camera};
    if (std::find(std::begin(kNamesOfFiles), std::end(kNamesOfFiles), given.name) ==
        std::end(kNamesOfFiles))
      continue;
    for (std::string& path : given.values) path = named(given.name, path, name);
  }
  for (std::string* const path :
       {&view.arguments.preview, &view.arguments.report, &view.arguments.stats,
        &view.arguments.nonzero, &view.arguments.checkpoint, &view.arguments.resume})
    if (!path->empty()) *path = named("", *path, name);
  return view;
}

// The portals of all cameras are one file.
View view_of_all(const Arguments& a, const cli::Common& common,
                 const std::vector<std::string>& all) {
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
  if (a.camera.names.size() > 1) throw UsageError("--frames: a shot is for one camera");
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
  if (a.shot.is_given()) {
    check_frames(a, common);
    return {{a, common}};
  }
  if (!may_be_several(a.camera.names) || a.scene.empty()) return {{a, common}};
  const Scene scene = read_gltf(a.scene);
  const std::vector<std::string> cameras = names_of_cameras(scene, a.camera.names);
  if (cameras.empty()) scene.camera("");  // throws
  if (!common.dependencies.empty())
    throw UsageError("--set dependencies: is for the picture of one camera");
  if (!common.output_given || cameras.size() == 1) return {{a, common}};
  if (asks_for_portals(common.output)) return {view_of_all(a, common, cameras)};
  std::vector<View> views;
  std::set<std::string> pictures;
  for (const std::string& camera : cameras) {
    scene.camera(camera);  // throws for a wrong one before the first picture is begun
    views.push_back(view_of(a, common, camera, cameras));
    const std::string& picture = views.back().common.output;
    if (!pictures.insert(picture).second)
      throw UsageError(
          fmt::format("-o {}: {} would be the picture of two cameras, one of them \"{}\"",
                      common.output, picture, camera));
  }
  return views;
}

}  // namespace tdpt
