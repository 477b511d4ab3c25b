#include "tools/portalfit/plane.h"

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

namespace {

Moments moments_of(const std::vector<Vec2d>& points) {
  Moments m;
  m.n = static_cast<double>(points.size());
  if (points.empty()) return m;
  for (const Vec2d& p : points) m.mean = m.mean + p;
  m.mean = m.mean * (1 / m.n);
  for (const Vec2d& p : points) {
    const Vec2d d = p - m.mean;
    m.xx += d.x * d.x, m.xy += d.x * d.y, m.yy += d.y * d.y;
  }
  m.xx /= m.n, m.xy /= m.n, m.yy /= m.n;
  return m;
}

}  // namespace

Moments trimmed_moments(const std::vector<Vec2d>& points) {
  const Moments all = moments_of(points);
  const double det = all.determinant();
  if (!(det > 0)) return all;
  std::vector<Vec2d> kept;
  kept.reserve(points.size());
  for (const Vec2d& p : points) {
    const Vec2d d = p - all.mean;
    // Squared Mahalanobis distance.
    if ((all.yy * d.x * d.x - 2 * all.xy * d.x * d.y + all.xx * d.y * d.y) / det <= 9)
      kept.push_back(p);
  }
  Moments m = moments_of(kept);
  m.n = all.n;
  return m;
}

Extents extents_of(const std::vector<Vec2d>& points) {
  const Moments m = moments_of(points);
  // The covariance has the eigenvalues half +- spread; a side of length s has the variance s^2 /
  // 12.
  const double turn = 0.5 * std::atan2(2 * m.xy, m.xx - m.yy), half = 0.5 * (m.xx + m.yy),
               spread = std::hypot(0.5 * (m.xx - m.yy), m.xy);
  return {m.mean,
          {std::cos(turn), std::sin(turn)},
          std::sqrt(12 * (half + spread)),
          std::sqrt(12 * std::max(0.0, half - spread))};
}

std::optional<Vec2d> crossing(const Plane& plane, const LightLine& line) {
  const auto passage = Slab({plane, 0}).passage(line);
  if (!passage) return {};
  return passage->at(0);
}

std::optional<Vec2d> clear_crossing(const Plane& plane, const LightLine& line) {
  const Vec3d d = line.camera - line.light;
  if (dot(d, plane.n) < kGrazing * length(d)) return {};
  return crossing(plane, line);
}

Vec3d to_space(const Plane& plane, Vec2d at) {
  const Onb<double> frame(plane.n);
  return plane.o + frame.x * at.x + frame.y * at.y;
}

Vec2d in_plane(const Plane& plane, const Vec3d& place) {
  const Onb<double> frame(plane.n);
  return {dot(place - plane.o, frame.x), dot(place - plane.o, frame.y)};
}

PortalShape shape_of(const Portal& portal) {
  PortalShape shape;
  Vec3d moment{}, normal{};
  for (const auto& t : portal.triangles) {
    const Vec3d p0 = portal.vertices[t[0]];
    const Vec3d e1 = portal.vertices[t[1]] - p0, e2 = portal.vertices[t[2]] - p0;
    const Vec3d n = cross(e1, e2);
    const double twice_area = length(n);
    shape.area += 0.5 * twice_area;
    moment += (p0 * 3 + e1 + e2) * (twice_area / 6);
    normal += n;
  }
  if (!(shape.area > 0)) return shape;
  shape.plane = {moment / shape.area, normalize(normal)};
  for (const auto& t : portal.triangles) {
    Polygon triangle;
    for (const uint32_t v : t) triangle.push_back(in_plane(shape.plane, portal.vertices[v]));
    if (area(triangle) > 0) shape.triangles.push_back(std::move(triangle));
  }
  return shape;
}

bool contains(const PortalShape& shape, Vec2d p) {
  return std::any_of(shape.triangles.begin(), shape.triangles.end(),
                     [&](const Polygon& t) { return contains(t, p); });
}

}  // namespace tdpt
