// Affine maps of space, in double precision.
#pragma once
#include <array>
#include <cmath>
#include <optional>

#include "libcommon/math/vec.h"

namespace tdpt {

/// Affine map p -> x p.x + y p.y + z p.z + t.
struct Affine {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, t{};
  Vec3d vector(const Vec3d& v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3d point(const Vec3d& p) const { return vector(p) + t; }
  Affine operator*(const Affine& b) const {
    return {vector(b.x), vector(b.y), vector(b.z), point(b.t)};
  }
  /// Without the translation; of a rotation the inverse.
  Affine transposed() const { return {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}, {}}; }
  /// Whether it changes handedness (negative determinant).
  bool mirrors() const {
    // Only the sign matters, so each column may be scaled: products stay in range.
    const auto scaled = [](const Vec3d& v) {
      const double s = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
      return s > 0 ? v / s : v;
    };
    return dot(cross(scaled(x), scaled(y)), scaled(z)) < 0;
  }
};

/// Translation * rotation (a quaternion x, y, z, w of any length) * scale; empty for a rotation of
/// zeros.
inline std::optional<Affine> affine_of(const Vec3d& translation,
                                       const std::array<double, 4>& rotation, const Vec3d& scale) {
  auto [x, y, z, w] = rotation;
  const double l = std::hypot(std::hypot(x, y), std::hypot(z, w));
  if (!(l > 0)) return {};
  x /= l, y /= l, z /= l, w /= l;
  Affine a;
  a.x = Vec3d(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)) * scale.x;
  a.y = Vec3d(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)) * scale.y;
  a.z = Vec3d(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)) * scale.z;
  a.t = translation;
  return a;
}

}  // namespace tdpt
