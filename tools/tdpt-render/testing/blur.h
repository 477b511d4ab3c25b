// For tests: a camera with a wide lens that moves and turns while its shutter is open.
#pragma once
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// `radius`: of the lens, canonical. It focuses at a third of the scene's size. `motion`: 1 moves
/// by about 0.15 and turns by about a quarter.
inline CameraBlur strong_blur(const Camera& camera, double radius = 0.06, double motion = 1) {
  std::vector<Camera> poses;
  for (int i = 0; motion > 0 && i < 4; ++i) {
    const double s = motion * (i / 3.0 - 0.5);
    Camera pose = camera;
    pose.position += camera.right * (0.1 * s) + camera.forward * (0.1 * s);
    pose.forward = normalize(camera.forward + camera.right * (0.25 * s) + camera.up * (0.1 * s));
    pose.right = normalize(cross(pose.forward, camera.up));
    pose.up = cross(pose.right, pose.forward);
    poses.push_back(pose);
  }
  return CameraBlur({radius, 0.7}, poses);
}

}  // namespace tdpt
