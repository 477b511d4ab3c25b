#include "tools/tdpt-import/pbrt/transforms.h"

#include <cmath>
#include <numbers>

namespace tdpt::foreign::pbrt {

Affine inverse(const Affine& a, const Place& place) {
  // Columns are scaled to keep the products in range.
  const double sx = length(a.x), sy = length(a.y), sz = length(a.z);
  if (!(sx > 0 && sy > 0 && sz > 0)) Source::fail(place, "the transformation flattens space");
  const Vec3d x = a.x / sx, y = a.y / sy, z = a.z / sz;
  const double det = dot(cross(x, y), z);
  if (!(std::abs(det) > 1e-12)) Source::fail(place, "the transformation flattens space");
  const Vec3d rx = cross(y, z) / (det * sx), ry = cross(z, x) / (det * sy),
              rz = cross(x, y) / (det * sz);
  Affine b;
  b.x = {rx.x, ry.x, rz.x};
  b.y = {rx.y, ry.y, rz.y};
  b.z = {rx.z, ry.z, rz.z};
  b.t = b.vector(a.t) * -1.0;
  if (!is_finite(b.x) || !is_finite(b.y) || !is_finite(b.z) || !is_finite(b.t))
    Source::fail(place, "the transformation flattens space");
  return b;
}

Affine translated(const Vec3d& by) {
  Affine a;
  a.t = by;
  return a;
}

Affine scaled_by(const Vec3d& by) {
  Affine a;
  a.x = {by.x, 0, 0};
  a.y = {0, by.y, 0};
  a.z = {0, 0, by.z};
  return a;
}

Affine rotated(double degrees, const Vec3d& axis) {
  const double l = length(axis), half = degrees * std::numbers::pi / 360;
  if (!(l > 0)) return {};
  const double s = std::sin(half) / l;
  return affine_of({}, {axis.x * s, axis.y * s, axis.z * s, std::cos(half)}, Vec3d(1)).value();
}

Affine looking(const Vec3d& from, const Vec3d& at, const Vec3d& up, const Place& place) {
  const Vec3d along = at - from;
  const Vec3d side = cross(up, along);
  if (!(length(side) > 1e-12 * length(up) * length(along)))
    Source::fail(place, "the direction of view is zero or parallel to \"up\"");
  Affine to_world;
  to_world.z = normalize(along);
  to_world.x = normalize(side);
  to_world.y = cross(to_world.z, to_world.x);
  to_world.t = from;
  return inverse(to_world, place);
}

Affine affine_of_matrix(std::span<const double> m, const Place& place) {
  if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] == 0)
    Source::fail(place, "a transformation with perspective");
  const double w = m[15];
  Affine a;
  a.x = Vec3d(m[0], m[1], m[2]) / w;
  a.y = Vec3d(m[4], m[5], m[6]) / w;
  a.z = Vec3d(m[8], m[9], m[10]) / w;
  a.t = Vec3d(m[12], m[13], m[14]) / w;
  return a;
}

}  // namespace tdpt::foreign::pbrt
