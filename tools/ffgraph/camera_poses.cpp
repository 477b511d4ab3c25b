#include "tools/ffgraph/camera_poses.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"

namespace tdpt {
namespace {

constexpr double kMoved = 1e-6;  // distance() of poses that differ, beyond rounding

double angle(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::clamp(dot(a, b), -1.0, 1.0));
}

// 1: far enough to count.
double distance(const Camera& a, const Camera& b) {
  return length(a.position - b.position) / kMovedFar +
         std::max(angle(a.forward, b.forward), angle(a.up, b.up)) / kTurnedFar;
}

}  // namespace

std::vector<size_t> telling_poses(const std::vector<Camera>& frames) {
  std::vector<size_t> poses{0};
  for (size_t k = 1; k < frames.size(); ++k)
    if (distance(frames[k], frames[poses.back()]) >= 1) poses.push_back(k);
  const size_t last = frames.size() - 1;
  if (distance(frames[last], frames[poses.back()]) > kMoved) poses.push_back(last);
  if (poses.size() <= kMostPoses) return poses;
  std::vector<size_t> few;
  for (size_t i = 0; i < kMostPoses; ++i)
    few.push_back(poses[(poses.size() - 1) * i / (kMostPoses - 1)]);
  return few;
}

std::vector<Camera> camera_poses(SceneFile& file, const Scene& scene,
                                 const std::vector<Camera>& cameras, const ShotArguments& shot) {
  const FrameRange range = frame_range(shot);
  std::vector<std::vector<Camera>> frames(cameras.size());
  for (int64_t k = range.first; k <= range.last; ++k) {
    const SceneFile::Glance now = file.glance_at(static_cast<double>(k) / shot.fps);
    if (now.pose_hash != scene.pose_hash)
      throw InputError(display_name(scene.path), "animations",
                       fmt::format("move more than cameras between frames {} and {}: portals are "
                                   "found frame by frame, with --at or --frames {}",
                                   range.first, k, range.first));
    for (size_t c = 0; c < cameras.size(); ++c) {
      const auto camera = std::find_if(now.cameras.begin(), now.cameras.end(),
                                       [&](const Camera& b) { return b.name == cameras[c].name; });
      if (camera == now.cameras.end())
        throw InputError(display_name(scene.path), "cameras",
                         fmt::format("\"{}\" is not there at frame {}", cameras[c].name, k));
      Camera& frame = frames[c].emplace_back(*camera);
      frame.position = scene.frame.to_canonical(camera->position);
      frame.culls = cameras[c].culls;
    }
  }
  std::vector<Camera> poses;
  for (const std::vector<Camera>& of_camera : frames)
    for (const size_t i : telling_poses(of_camera)) {
      Camera& pose = poses.emplace_back(of_camera[i]);
      pose.name = camera_at_frame(pose.name, range.first + static_cast<int64_t>(i));
    }
  return poses;
}

}  // namespace tdpt
