// A portal as a flat shape: its plane, and its triangles within it.
#pragma once
#include <vector>

#include "libcommon/formats/portal.h"
#include "tools/portalfit/plane.h"

namespace tdpt {

struct PortalShape {
  double area = 0;                 ///< [m2]; 0: all triangles are degenerate, there is no plane
  Plane plane{};                   ///< through the centroid, with the triangles' normal
  std::vector<Polygon> triangles;  ///< in the plane, without degenerate ones
};
PortalShape shape_of(const Portal& portal);

/// Whether some triangle contains `p`, a point of the plane.
bool contains(const PortalShape& shape, Vec2d p);

}  // namespace tdpt
