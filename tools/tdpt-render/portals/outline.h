// Re-triangulates a polygon with as few triangles as possible, since every edge of a path is tested
// against every triangle of a portal.
//
// Method: edges without an opposite edge form the outline; corners within a straight side are
// dropped; holes are joined to the outer loop by bridges; then ear clipping.
#pragma once
#include <vector>

#include "tools/tdpt-render/portals/facets.h"

namespace tdpt {

/// Triangles that cover the same area as those of the facet. Triangles connected by edges are
/// handled together: replaced if the new ones are fewer, and kept if they overlap or their outline
/// touches itself. `tolerance`: distance up to which a corner counts as part of a straight side, in
/// the unit of the corners; the area changes by no more than that times the outline's length.
std::vector<Corners> fewest_triangles(const PlanarFacet& facet, double tolerance);

}  // namespace tdpt
