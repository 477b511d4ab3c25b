// Turns a portal as drawn into planar polygons of few triangles: modelling programs know nothing of
// portals, and every extra triangle or plane costs time.
//
// flatness  |sum of A n| / sum of A over the triangles of each connected part, averaged by area: 1
// if
//           planar, 0 for the surface of a closed body, 1/2 for half a sphere.
#pragma once
#include "libcommon/formats/portal.h"

namespace tdpt {

/// A mesh of less flatness cannot be an opening.
inline constexpr double kLeastFlatness = 0.5;
/// Corners may lie this far off a plane and are moved into it, as a share of the extent of the
/// part.
inline constexpr double kBent = 0.02;

struct PortalMesh {
  enum Shape {
    planar,
    flattened,  ///< its parts are planar within kBent, or would take too many planes
    lid,        ///< it bulges out of a planar rim and is replaced by the polygon in its rim
    bent,       ///< it takes more planes than it has parts, within kBent if they are many
    folded,     ///< cannot be an opening; left as drawn
    body        ///< closed; left as drawn
  } shape = planar;
  double off = 0;        ///< farthest that a corner was moved into its plane [m]
  size_t planes = 0;     ///< number of planes that it is used as
  size_t triangles = 0;  ///< as drawn; duplicates count once
  bool turned = false;   ///< some triangles were turned, so that neighbours face the same way
};

/// Flattens the triangles of a portal into planes: duplicates are dropped (if one faces the other
/// way, the portal works both ways), neighbours turned to agree, corners moved into planes,
/// triangles of one plane replaced by fewer that cover the same. A portal that needs none of this
/// keeps its bytes.
PortalMesh tidy(Portal& portal);

}  // namespace tdpt
