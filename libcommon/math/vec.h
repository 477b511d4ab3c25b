// Vector operations that only C++ needs; the types are shared with kernels.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "shaders/shared/vector.h"

namespace tdpt {

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
using Rgb = Vec3f;

using shader::cross;
using shader::dot;
using shader::luminance;

template <class T>
T length(const Vec3<T>& a) {
  return std::sqrt(dot(a, a));
}
/// `a` scaled to length 1. a must not be 0.
template <class T>
Vec3<T> normalize(const Vec3<T>& a) {
  return a / length(a);
}
template <class T>
constexpr Vec3<T> min(const Vec3<T>& a, const Vec3<T>& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
template <class T>
constexpr Vec3<T> max(const Vec3<T>& a, const Vec3<T>& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
template <class T>
constexpr T max_component(const Vec3<T>& a) {
  return std::max({a.x, a.y, a.z});
}
template <class T>
bool is_finite(const Vec3<T>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// shader::Onb as an object: the orthonormal frame whose z is a given unit normal.
template <class T>
struct Onb : shader::Onb<T> {
  explicit Onb(const Vec3<T>& normal) : shader::Onb<T>(shader::onb_about(normal)) {}
  Vec3<T> to_world(const Vec3<T>& v) const { return shader::to_world(*this, v); }
  Vec3<T> to_local(const Vec3<T>& w) const { return shader::to_local(*this, w); }
};

// Affine maps of space, in double precision.

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
