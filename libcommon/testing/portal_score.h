// How well portals fill an opening whose place is known: rectangle, normal, thickness of the wall.
#pragma once
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/math/rng.h"
#include "libcommon/math/warp.h"

namespace tdpt::testing {

/// A rectangular opening in a wall: corner, corner + u, corner + v, corner + u + v on the wall's
/// middle plane; light goes along `normal` (unit, perpendicular to u and v).
struct Aperture {
  Vec3d corner, u, v, normal;
  double thickness;  ///< of the wall
};

/// The straight line through `point` along `direction` meets the portal along its normal.
inline bool crosses(const Portal& portal, const Vec3d& point, const Vec3d& direction) {
  for (const auto& t : portal.triangles) {
    const Vec3d p0 = portal.vertices[t[0]];
    const Vec3d e1 = portal.vertices[t[1]] - p0, e2 = portal.vertices[t[2]] - p0;
    const Vec3d n = cross(e1, e2);
    const double slope = dot(n, direction);
    if (!(slope > 0)) continue;
    const Vec3d at = point + direction * (dot(n, p0 - point) / slope) - p0;
    const double b1 = dot(cross(at, e2), n) / dot(n, n), b2 = dot(cross(e1, at), n) / dot(n, n);
    if (b1 >= 0 && b2 >= 0 && b1 + b2 <= 1) return true;
  }
  return false;
}

/// Share of the lines through the opening (uniform places, cosine directions, passing both faces
/// of the wall) that cross one of the portals along its normal.
inline double coverage(const Aperture& o, const std::vector<Portal>& portals) {
  Rng rng(1, 0, 0);
  const Onb<double> frame(o.normal);
  int lines = 0, covered = 0;
  while (lines < 20000) {
    const double a = rng.uniform();
    const double b = rng.uniform();
    const double c = rng.uniform();
    const double d = rng.uniform();
    const Vec3d w = frame.to_world(cosine_hemisphere(c, d));
    const Vec3d p = o.corner + o.u * a + o.v * b;
    bool passes = true;
    for (double side : {-0.5, 0.5}) {
      const Vec3d at = p + w * (side * o.thickness / dot(w, o.normal)) - o.corner;
      const double s = dot(at, o.u) / dot(o.u, o.u), t = dot(at, o.v) / dot(o.v, o.v);
      passes = passes && s >= 0 && s <= 1 && t >= 0 && t <= 1;
    }
    if (!passes) continue;
    ++lines;
    for (const Portal& portal : portals) {
      if (crosses(portal, p, w)) {
        ++covered;
        break;
      }
    }
  }
  return static_cast<double>(covered) / lines;
}

/// Area-weighted normal of a portal, unit.
inline Vec3d mean_normal(const Portal& portal) {
  Vec3d sum;
  for (const auto& t : portal.triangles)
    sum += cross(portal.vertices[t[1]] - portal.vertices[t[0]],
                 portal.vertices[t[2]] - portal.vertices[t[0]]);
  return normalize(sum);
}

inline double degrees_between(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::clamp(dot(a, b), -1.0, 1.0)) * 57.29577951308232;
}

}  // namespace tdpt::testing
