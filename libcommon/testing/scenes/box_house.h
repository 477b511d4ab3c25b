// Houses of boxes for tests, in metres.
#pragma once
#include "libcommon/scene/scene.h"

namespace tdpt::draw {

class TestHouse {
 public:
  TestHouse() { scene.materials.resize(1); }

  /// A body whose normals point outwards, or inwards, as of a room without walls.
  void box(const Vec3d& low, const Vec3d& high, bool outwards = true) {
    const auto corner = [&](int k) {
      return Vec3d{k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z};
    };
    constexpr int kQuads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                  {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& q : kQuads)
      outwards ? quad(corner(q[0]), corner(q[1]), corner(q[2]), corner(q[3]))
               : quad(corner(q[3]), corner(q[2]), corner(q[1]), corner(q[0]));
  }
  void quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    const auto first = static_cast<uint32_t>(scene.positions.size());
    for (const Vec3d& p : {a, b, c, d}) scene.positions.emplace_back(p);
    scene.triangles.push_back({{first, first + 1, first + 2}, 0});
    scene.triangles.push_back({{first, first + 2, first + 3}, 0});
  }

  Scene scene;
};

/// Storeys of 8 x 6 m, x 0..8 and z 0..6, with floors at 0, 2.8 ... and walls of 0.3 m. On the
/// ground floor a wall x 4..4.2 with a doorway z 2..2.9.
inline TestHouse test_house(int storeys, bool doorway = true) {
  constexpr double kStorey = 2.8, kSlab = 0.3;
  TestHouse h;
  for (int k = 0; k <= storeys; ++k) h.box({0, k * kStorey - kSlab, 0}, {8, k * kStorey, 6});
  for (int k = 0; k < storeys; ++k) {
    const double low = k * kStorey, high = low + kStorey - kSlab;
    h.box({0, low, 0}, {0.3, high, 6});
    h.box({7.7, low, 0}, {8, high, 6});
    // These overlap those at the corners.
    h.box({0, low, 0}, {8, high, 0.3});
    h.box({0, low, 5.7}, {8, high, 6});
  }
  h.box({4, 0, 0.3}, {4.2, 2.5, doorway ? 2 : 2.9});
  h.box({4, 0, 2.9}, {4.2, 2.5, 5.7});
  return h;
}

}  // namespace tdpt::draw
