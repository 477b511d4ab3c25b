// Convex polygons in a plane.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tdpt {

struct Vec2d {
  double x = 0, y = 0;
  friend constexpr Vec2d operator+(Vec2d a, Vec2d b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vec2d operator-(Vec2d a, Vec2d b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vec2d operator*(Vec2d a, double s) { return {a.x * s, a.y * s}; }
};
constexpr double dot(Vec2d a, Vec2d b) {
  return a.x * b.x + a.y * b.y;
}
constexpr double cross(Vec2d a, Vec2d b) {
  return a.x * b.y - a.y * b.x;
}

/// Corners counter-clockwise.
using Polygon = std::vector<Vec2d>;

/// Convex hull, counter-clockwise; fewer than three corners if the points are collinear (CGAL).
Polygon convex_hull(const std::vector<Vec2d>& points);
/// Delaunay triangulation of a convex polygon's corners, counter-clockwise (CGAL).
std::vector<std::array<uint32_t, 3>> triangulate(const Polygon& polygon);

double area(const Polygon& polygon);
/// Whether the convex polygon contains p, border included.
bool contains(const Polygon& polygon, Vec2d p);
/// Scales about the centre of mass until the area has grown by the factor `growth`.
Polygon enlarged(const Polygon& polygon, double growth);
/// The part of the convex polygon with dot(axis, p) <= limit.
Polygon clipped(const Polygon& polygon, Vec2d axis, double limit);
/// A convex polygon around `polygon` with fewer corners: edges are removed by extending their
/// neighbours, the one that adds least area first, until the next would add more than `tolerance`
/// of the area.
Polygon simplified(const Polygon& polygon, double tolerance);

}  // namespace tdpt
