// Openings beside each other in one plane, as the panes of a window or the gaps between slats: one
// opening, with bars in it.
#pragma once
#include <vector>

#include "tools/portalfit/aperture.h"

namespace tdpt {

/// What flat shapes have in common. `voxel`: side of the grid's [metres], its resolution.
struct Joint {
  Plane plane;        ///< the nearest to all corners, along the mean normal
  Polygon outline;    ///< convex, around them all
  double open = 0;    ///< share of the outline that the shapes leave open
  bool flat = false;  ///< whether they lie in that plane
};
Joint joint_of(const std::vector<Aperture>& parts, double voxel);

/// The least distance between two convex outlines in one plane; 0 where they meet.
double distance_between(const Polygon& a, const Polygon& b);

/// Joins what lies in one plane across bars as thin as the grid resolves, and where most of the
/// outline around both is open across mullions; not across the pier between two windows. Of more
/// than `most` parts those are joined that leave enough of it open, until there are no more than
/// that. Each that is joined is laid again through its lines, which are those of `all`.
std::vector<Aperture> joined_in_planes(const Bundle& all, std::vector<Aperture> parts, size_t most,
                                       double voxel);

}  // namespace tdpt
