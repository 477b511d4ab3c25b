// Minimum-area rectangle: it has a side along an edge of the points' convex hull (Freeman and
// Shapira 1975), so each edge is tried; outlines have a dozen corners.
#include "tools/portalfit/renderers.h"

#include <algorithm>
#include <limits>

#include "tools/portalfit/plane.h"

namespace tdpt {
namespace {

constexpr double kSameWay = 0.9;   // cosine between normals
constexpr double kOverlap = 1e-6;  // of the smaller area

// A rectangle in a plane: from `low` to `high` along the unit vectors u and v, v left of u.
struct FlatBox {
  Vec2d u, v, low, high;

  double area() const { return (high.x - low.x) * (high.y - low.y); }
};

FlatBox box_along(const Polygon& hull, Vec2d u) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  FlatBox box{u, {-u.y, u.x}, {kFar, kFar}, {-kFar, -kFar}};
  for (const Vec2d& p : hull) {
    const Vec2d at{dot(p, box.u), dot(p, box.v)};
    box.low = {std::min(box.low.x, at.x), std::min(box.low.y, at.y)};
    box.high = {std::max(box.high.x, at.x), std::max(box.high.y, at.y)};
  }
  return box;
}

FlatBox least_box(const Polygon& hull) {
  FlatBox best;
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < hull.size(); ++i) {
    const Vec2d edge = hull[(i + 1) % hull.size()] - hull[i];
    const double length = std::sqrt(dot(edge, edge));
    if (!(length > 0)) continue;
    const FlatBox box = box_along(hull, edge * (1 / length));
    // Edges of the same rectangle differ only by rounding: the first is kept.
    if (box.area() < least * (1 - 1e-12)) least = box.area(), best = box;
  }
  return best;
}

// Orients the sides as the header says: y vertical, else x the longer.
void turn_upright(Rectangle& r) {
  constexpr double kLevel = 1e-9;
  const bool level = std::abs(r.x.y) < kLevel && std::abs(r.y.y) < kLevel;
  if (level ? r.height > r.width : std::abs(r.x.y) > std::abs(r.y.y)) {
    std::swap(r.width, r.height);
    r.y = r.x;
  }
  if (!level && r.y.y < 0) r.y = -r.y;
  r.x = cross(r.y, r.normal);
}

Portal portal_around(const Portal& a, const Portal& b) {
  // The rectangle around both lies in the plane of the larger.
  Portal both = area_of(a) < area_of(b) ? b : a;
  const Plane plane = shape_of(both).plane;
  both.vertices.clear();
  for (const Portal* p : {&a, &b})
    for (const Vec3d& corner : rectangle_of(*p).corners())
      both.vertices.push_back(to_space(plane, in_plane(plane, corner)));
  both.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  both.vertices = rectangle_of(both).corners();
  both.triangles = {{0, 1, 2}, {0, 2, 3}};
  both.figures = a.figures;
  both.name = a.name + ", " + b.name;
  return both;
}

// Whether `a` and `b` overlap when seen along the normal of `a`, and are close along it.
bool overlap(const Rectangle& a, const Rectangle& b) {
  if (dot(a.normal, b.normal) < kSameWay) return false;
  const double close = 0.5 * std::min({a.width, a.height, b.width, b.height});
  if (std::abs(dot(b.centre - a.centre, a.normal)) > close) return false;
  Polygon seen;
  for (const Vec3d& corner : b.corners())
    seen.push_back({dot(corner - a.centre, a.x), dot(corner - a.centre, a.y)});
  const double smaller = std::min(a.width * a.height, area(seen));
  for (const Vec2d& axis : {Vec2d{1, 0}, Vec2d{-1, 0}})
    if (!seen.empty()) seen = clipped(seen, axis, 0.5 * a.width);
  for (const Vec2d& axis : {Vec2d{0, 1}, Vec2d{0, -1}})
    if (!seen.empty()) seen = clipped(seen, axis, 0.5 * a.height);
  return seen.size() > 2 && area(seen) > kOverlap * smaller;
}

// Joins two that overlap; returns false if there are none.
bool join_a_pair(std::vector<Portal>& portals) {
  for (size_t i = 0; i < portals.size(); ++i)
    for (size_t j = i + 1; j < portals.size(); ++j)
      if (overlap(rectangle_of(portals[i]), rectangle_of(portals[j]))) {
        portals[i] = portal_around(portals[i], portals[j]);
        portals.erase(portals.begin() + static_cast<std::ptrdiff_t>(j));
        return true;
      }
  return false;
}

}  // namespace

std::vector<Vec3d> Rectangle::corners() const {
  const Vec3d a = x * (0.5 * width), b = y * (0.5 * height);
  return {centre - a - b, centre + a - b, centre + a + b, centre - a + b};
}

Rectangle rectangle_of(const Portal& portal) {
  const Plane plane = shape_of(portal).plane;
  std::vector<Vec2d> places;
  for (const auto& t : portal.triangles)
    for (const uint32_t v : t) places.push_back(in_plane(plane, portal.vertices[v]));
  const FlatBox box = least_box(convex_hull(places));
  const Vec2d middle = (box.low + box.high) * 0.5;
  Rectangle r;
  r.normal = plane.n;
  r.centre = to_space(plane, box.u * middle.x + box.v * middle.y);
  r.x = to_space({{}, plane.n}, box.u);
  r.y = cross(r.normal, r.x);
  r.width = box.high.x - box.low.x;
  r.height = box.high.y - box.low.y;
  turn_upright(r);
  return r;
}

std::vector<Portal> without_overlaps(std::vector<Portal> portals) {
  // A joined rectangle may overlap with one examined before.
  while (join_a_pair(portals)) continue;
  return portals;
}

}  // namespace tdpt
