// Convex hull and triangulation, by CGAL: the only source that includes it.
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/convex_hull_2.h>

#include "tools/portalfit/plane.h"

namespace tdpt {
namespace {
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<Vertex>;
using Delaunay = CGAL::Delaunay_triangulation_2<Kernel, Structure>;
}  // namespace

Polygon convex_hull(const std::vector<Vec2d>& points) {
  std::vector<Kernel::Point_2> in, out;
  in.reserve(points.size());
  for (const Vec2d& p : points) in.emplace_back(p.x, p.y);
  CGAL::convex_hull_2(in.begin(), in.end(), std::back_inserter(out));
  Polygon hull;
  for (const auto& p : out) hull.push_back({p.x(), p.y()});
  return hull;
}

std::vector<std::array<uint32_t, 3>> triangulate(const Polygon& polygon) {
  Delaunay delaunay;
  std::vector<std::pair<Kernel::Point_2, uint32_t>> corners;
  for (uint32_t i = 0; i < polygon.size(); ++i)
    corners.emplace_back(Kernel::Point_2(polygon[i].x, polygon[i].y), i);
  // One by one: bulk insertion shuffles.
  for (const auto& [point, i] : corners) delaunay.insert(point)->info() = i;
  std::vector<std::array<uint32_t, 3>> triangles;
  for (auto f = delaunay.finite_faces_begin(); f != delaunay.finite_faces_end(); ++f)
    triangles.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
  return triangles;
}

}  // namespace tdpt
