// The smallest rectangle around a portal, for renderers whose portals are rectangles.
#pragma once
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/math/vec.h"

namespace tdpt {

/// In space [m]. x, y and normal are unit vectors with cross(x, y) = normal, the way the light
/// goes; width is along x, height along y. y is the side that stands upright (+Y); where neither
/// does, as in a skylight, x is the longer one.
struct Rectangle {
  Vec3d centre, x, y, normal;
  double width = 0, height = 0;

  /// Counter-clockwise seen from where the light goes to.
  std::vector<Vec3d> corners() const;
};

/// The one of least area, in the portal's plane; its triangles are planar and have an area.
Rectangle rectangle_of(const Portal& portal);

/// Portals that share no place: such as face the same way and whose rectangles overlap, seen along
/// their normal, become one, the rectangle around both, with both names and the figures of the
/// first.
std::vector<Portal> without_overlaps(std::vector<Portal> portals);

}  // namespace tdpt
