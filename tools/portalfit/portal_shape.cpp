#include "tools/portalfit/portal_shape.h"

#include <algorithm>

namespace tdpt {

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
