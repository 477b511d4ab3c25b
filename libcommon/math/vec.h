// Vector operations that only C++ needs; the types are shared with kernels.
#pragma once
#include <algorithm>
#include <cmath>

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

}  // namespace tdpt
