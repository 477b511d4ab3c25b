#include "tools/tdpt/views.h"

#include <algorithm>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/formats/shot_options.h"
#include "libcommon/scene/scene_file.h"

namespace tdpt {
namespace {

constexpr int64_t kFramesPerPortals = 12;  // from key to key, while the scene moves
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

// A part of a shot, and the frames for which its portals are found.
struct Part {
  FrameRange frames, portals;
};

std::string words_of(const FrameRange& range) {
  return range.first == range.last ? fmt::format("{}", range.first)
                                   : fmt::format("{}-{}", range.first, range.last);
}

// Frames in which the scene stands still but for cameras share their portals. While it moves, the
// portals of a frame are those of the nearest key.
std::vector<Part> parts_of(const Arguments& a) {
  SceneFile file(a.scene, a.pose.animations);
  const FrameRange range = frame_range(a.shot);
  std::vector<FrameRange> still;  // runs of equal poses
  std::string before;
  for (int64_t k = range.first; k <= range.last; ++k) {
    std::string pose = file.glance_at(static_cast<double>(k) / a.shot.fps).pose_hash;
    if (k > range.first && pose == before)
      still.back().last = k;
    else
      still.push_back({k, k});
    before = std::move(pose);
  }
  std::vector<Part> parts;
  for (size_t i = 0; i < still.size();) {
    if (still[i].count() > 1) {
      parts.push_back({still[i], still[i]});
      ++i;
      continue;
    }
    size_t end = i;
    while (end < still.size() && still[end].count() == 1) ++end;
    const std::vector<int64_t> keys =
        key_frames({still[i].first, still[end - 1].last}, kFramesPerPortals);
    for (const int64_t first = still[i].first; i < end; ++i) {
      const int64_t frame = still[i].first, key = nearest_key(keys, frame);
      if (frame > first && parts.back().portals.first == key)
        parts.back().frames.last = frame;
      else
        parts.push_back({{frame, frame}, {key, key}});
    }
  }
  return parts;
}

std::vector<View> views_of_shot(const Arguments& a, const cli::Common& common) {
  if (a.camera.names.size() > 1) throw UsageError("--frames: a shot is for one camera");
  for (const auto& [option, path] : {std::pair("-o", &common.output),
                                     {"--preview", &a.preview},
                                     {"--stats", &a.stats},
                                     {"--set nonzero", &a.nonzero},
                                     {"--checkpoint", &a.checkpoint},
                                     {"--resume", &a.resume}})
    if (!path->empty()) name_of_frame(option, *path, 0);
  std::vector<View> views;
  for (const Part& part : parts_of(a)) {
    View view{a, common};
    view.arguments.shot.frames = words_of(part.frames);
    view.arguments.portal_frames = words_of(part.portals);
    for (cli::Given& given : view.common.given)
      if (given.name == "--frames") given.values = {view.arguments.shot.frames};
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace

std::vector<View> views_of(const Arguments& a, const cli::Common& common) {
  if (a.shot.is_given() && !a.scene.empty()) return views_of_shot(a, common);
  if (!may_be_several(a.camera.names) || a.scene.empty()) return {{a, common}};
  const Scene scene = read_gltf(a.scene);
  const std::vector<std::string> cameras = names_of_cameras(scene, a.camera.names);
  if (cameras.empty())
    throw InputError(a.scene, "cameras", "the scene has no camera, expected a perspective camera");
  if (!common.dependencies.empty())
    throw UsageError("--set dependencies: is for the picture of one camera");
  if (!common.output_given || cameras.size() == 1) return {{a, common}};
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
