// A portal as a flat shape: its plane, and its triangles within it.
#pragma once
#include <vector>

#include "libcommon/formats/portal.h"
#include "tools/portalfit/plane.h"

namespace tdpt {

struct PortalShape {
  double area = 0;                 ///< [m2]; 0: no triangle has any, and there is no plane
  Plane plane{};                   ///< through the middle of the area, normal as the triangles'
  std::vector<Polygon> triangles;  ///< in the plane; those that have an area
};
PortalShape shape_of(const Portal& portal);

/// Whether some triangle holds `p` of the plane.
bool contains(const PortalShape& shape, Vec2d p);

}  // namespace tdpt
