// The smallest rectangle around a portal, for renderers that support rectangles only.
#pragma once
#include <vector>

#include "libcommon/formats/portal.h"
#include "libcommon/math/vec.h"

namespace tdpt {

/// In space [m]. x, y and normal are unit vectors with cross(x, y) = normal, the way the light
/// goes; width is along x, height along y. y is the more vertical side (+Y); in a horizontal
/// rectangle, such as a skylight, x is the longer side.
struct Rectangle {
  Vec3d centre, x, y, normal;
  double width = 0, height = 0;

  /// Counter-clockwise seen from where the light goes.
  std::vector<Vec3d> corners() const;
};

/// The rectangle of least area in the portal's plane; its triangles must be planar and have an
/// area.
Rectangle rectangle_of(const Portal& portal);

/// Merges overlapping portals: those that face the same way and whose rectangles overlap along
/// their normal become the rectangle around both, with both names and the figures of the first.
std::vector<Portal> without_overlaps(std::vector<Portal> portals);

}  // namespace tdpt
