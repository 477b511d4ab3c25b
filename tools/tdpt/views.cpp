#include "tools/tdpt/views.h"

#include <algorithm>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"

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
  return replaced(path, "%", name);
}

// The files of one of several cameras, each with its name.
void name_files(View& view, const std::string& name, bool several) {
  const auto rename = [&](const std::string& option, std::string& path) {
    if (several && path.find('%') == path.npos)
      throw UsageError(
          fmt::format("{} {}: there are several cameras; write % where their names are to stand",
                      option, path));
    path = named(path, name);
  };
  rename("-o", view.common.output);
  for (cli::Given& given : view.common.given)
    if (std::find(std::begin(kNamesOfFiles), std::end(kNamesOfFiles), given.name) !=
        std::end(kNamesOfFiles))
      for (std::string& path : given.values) rename(given.name, path);
  Arguments& a = view.arguments;
  for (std::string* const path : {&view.common.dependencies, &a.preview, &a.report, &a.stats,
                                  &a.nonzero, &a.checkpoint, &a.resume})
    *path = named(*path, name);
  for (cli::NamedFile& file : view.common.outputs) file.path = named(file.path, name);
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
