#include "tools/tdpt-import/gltf/frame.h"

#include <cmath>

namespace tdpt::foreign {

Frame frame_of(const Described& scene, Up up) {
  Frame frame;
  if (!scene.cameras.empty()) {
    const Affine& camera = scene.cameras.front().to_world;
    frame.mirrored = camera.mirrors();
    if (up == Up::by_camera) {
      const Vec3d& y = camera.y;
      const double x = std::abs(y.x), z = std::abs(y.z), upright = std::abs(y.y);
      up = upright >= x && upright >= z ? Up::y : z >= x ? Up::z : Up::x;
      frame.downwards = (up == Up::y ? y.y : up == Up::z ? y.z : y.x) < 0;
    }
  }
  if (up == Up::by_camera) up = Up::y;
  frame.up = up;
  // Rotations that take the axis to +y and keep one of the others.
  Affine turn;
  if (up == Up::z) turn = {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {}};
  if (up == Up::x) turn = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {}};
  if (frame.downwards) turn = Affine{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}} * turn;
  if (frame.mirrored) turn = turn * Affine{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}};
  frame.to_gltf = turn;
  return frame;
}

}  // namespace tdpt::foreign
