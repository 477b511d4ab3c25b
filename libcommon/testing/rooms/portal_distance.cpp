#include "libcommon/testing/rooms/portal_distance.h"

#include <algorithm>
#include <cmath>

namespace tdpt::testing {
namespace {

double to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d d = b - a;
  const double t = std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0);
  return length(p - a - d * t);
}

double to_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d n = cross(b - a, c - a), at = p - a;
  const double b1 = dot(cross(at, c - a), n) / dot(n, n);
  const double b2 = dot(cross(b - a, at), n) / dot(n, n);
  if (b1 >= 0 && b2 >= 0 && b1 + b2 <= 1) return std::abs(dot(at, n)) / length(n);
  return std::min({to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
}

// For a convex portal the maximum is at a corner.
double one_way(const Portal& from, const Portal& to) {
  double farthest = 0;
  for (const Vec3d& v : from.vertices) {
    double nearest = INFINITY;
    for (const auto& t : to.triangles)
      nearest = std::min(nearest,
                         to_triangle(v, to.vertices[t[0]], to.vertices[t[1]], to.vertices[t[2]]));
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

}  // namespace

double distance(const Portal& a, const Portal& b) {
  return std::max(one_way(a, b), one_way(b, a));
}

double distance_to_nearest(const Portal& portal, const std::vector<Portal>& others) {
  double nearest = INFINITY;
  for (const Portal& other : others) nearest = std::min(nearest, distance(portal, other));
  return nearest;
}

}  // namespace tdpt::testing
