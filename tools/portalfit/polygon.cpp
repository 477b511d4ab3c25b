#include "tools/portalfit/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tdpt {

double area(const Polygon& polygon) {
  double twice = 0;
  for (size_t i = 2; i < polygon.size(); ++i)
    twice += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return 0.5 * twice;
}

bool contains(const Polygon& polygon, Vec2d p) {
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if (cross(b - a, p - a) < 0) return false;
  }
  return polygon.size() >= 3;
}

Polygon enlarged(const Polygon& polygon, double growth) {
  Vec2d centre;
  double total = 0;
  for (size_t i = 2; i < polygon.size(); ++i) {
    const double w = cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
    centre = centre + (polygon[0] + polygon[i - 1] + polygon[i]) * (w / 3);
    total += w;
  }
  if (!(total > 0)) return polygon;
  centre = centre * (1 / total);
  const double scale = std::sqrt(growth);
  Polygon larger;
  for (const Vec2d& p : polygon) larger.push_back(centre + (p - centre) * scale);
  return larger;
}

Polygon clipped(const Polygon& polygon, Vec2d axis, double limit) {
  Polygon kept;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec2d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double dp = limit - dot(p, axis), dq = limit - dot(q, axis);
    if (dp >= 0) kept.push_back(p);
    if ((dp >= 0) != (dq >= 0)) kept.push_back(p + (q - p) * (dp / (dp - dq)));
  }
  // A cut through a corner duplicates it but for rounding, and an edge of no length has no sides.
  double size = 0;
  for (const Vec2d& p : kept) size = std::max({size, std::abs(p.x), std::abs(p.y)});
  constexpr double kSame = 1e-9;
  Polygon clean;
  for (size_t i = 0; i < kept.size(); ++i) {
    const Vec2d d = kept[(i + 1) % kept.size()] - kept[i];
    if (std::max(std::abs(d.x), std::abs(d.y)) > kSame * size) clean.push_back(kept[i]);
  }
  return clean;
}

Polygon simplified(const Polygon& polygon, double tolerance) {
  Polygon p = polygon;
  const double whole = area(polygon);
  while (p.size() > 3) {
    const size_t n = p.size();
    double least = std::numeric_limits<double>::infinity();
    size_t edge = n;
    Vec2d corner;
    for (size_t i = 0; i < n; ++i) {
      // Removes edge b-c; a-b and d-c are extended until they meet.
      const Vec2d &a = p[(i + n - 1) % n], &b = p[i], &c = p[(i + 1) % n], &d = p[(i + 2) % n];
      const double turn = cross(b - a, d - c);
      if (!(turn < 0 || turn > 0)) continue;
      const double s = cross(c - b, d - c) / turn;  // b + s (b - a)
      const double t = cross(b - a, c - b) / turn;  // c + t (c - d)
      if (!(s >= 0) || !(t >= 0) || !std::isfinite(s) || !std::isfinite(t)) continue;
      const Vec2d meet = b + (b - a) * s;
      const double added = 0.5 * cross(meet - b, c - b);
      if (std::abs(added) < least) least = std::abs(added), edge = i, corner = meet;
    }
    if (edge == n || least > tolerance * whole) break;
    p[edge] = corner;
    p.erase(p.begin() + static_cast<std::ptrdiff_t>((edge + 1) % n));
  }
  return p;
}

}  // namespace tdpt
