// The fewest triangles for a polygon that was drawn with many: every edge of a path is tested
// against every triangle of a portal.
//
// Method: edges without an opposite are the outline; corners within a straight side are left out;
// holes are joined to the outer loop by bridges; ears are cut off (ear clipping).
#pragma once
#include <vector>

#include "tools/tdpt-render/portals/facets.h"

namespace tdpt {

/// Triangles that cover what those of the facet cover. Those that share edges are taken together:
/// replaced where the new ones are fewer, and left as they are where they overlap or their outline
/// touches itself. `tolerance`: how far a corner may lie from a straight side and be part of it, in
/// the unit of the corners; the area changes by no more than that times the outline's length.
std::vector<Corners> fewest_triangles(const PlanarFacet& facet, double tolerance);

}  // namespace tdpt
