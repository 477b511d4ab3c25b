// A portal as it was drawn, made into planar polygons of few triangles: modelling programs know
// nothing of portals, and every triangle, and every plane more, costs time.
//
// flatness  |sum of A n| / sum of A over the triangles, for each part that hangs together, weighed
//           by area: 1 for what is planar, 0 for the surface of a body, 1/2 for half a sphere.
#pragma once
#include "libcommon/formats/portal.h"

namespace tdpt {

/// Less flatness is no opening's.
inline constexpr double kLeastFlatness = 0.5;
/// Corners may lie this far off a plane and are laid into it, of the extent of the part.
inline constexpr double kBent = 0.02;

struct PortalMesh {
  enum Shape {
    planar,
    flattened,  ///< its parts are planar but for kBent, or would take too many planes
    lid,        ///< it bulges out of a planar rim: the polygon in its rim takes its place
    bent,       ///< it takes more planes than it has parts; where they are many, but for kBent
    folded,     ///< no opening, and left as drawn
    body        ///< closed: likewise
  } shape = planar;
  double off = 0;        ///< farthest that a corner was laid into its plane [m]
  size_t planes = 0;     ///< it is used as so many
  size_t triangles = 0;  ///< as drawn; copies of one count once
  bool turned = false;   ///< some triangles, so that neighbours face the same way
};

/// Brings the triangles of a portal into planes: copies left out (where one faces the other way,
/// the portal works both ways), neighbours turned to agree, corners laid into planes, triangles of
/// one plane replaced by fewer that cover the same. What needs nothing of it keeps its bytes.
PortalMesh tidy(Portal& portal);

}  // namespace tdpt
