// Joins openings side by side in one plane, such as the panes of a window or the gaps between
// slats, into one opening with bars in it.
#pragma once
#include <vector>

#include "tools/portalfit/aperture.h"

namespace tdpt {

/// Joint geometry of flat shapes.
struct Joint {
  Plane plane;        ///< least squares to all corners, along the mean normal
  Polygon outline;    ///< convex, around all of them
  double open = 0;    ///< share of the outline that the shapes leave open
  bool flat = false;  ///< whether they lie in that plane
};
Joint joint_of(const FitInput& in, const std::vector<Aperture>& parts);

/// The least distance between two convex outlines in one plane; 0 if they touch.
double distance_between(const Polygon& a, const Polygon& b);

/// Joins openings in one plane across bars as thin as the grid resolves, and across mullions if
/// most of the joint outline is open; not across the pier between two windows. While there are more
/// than `most` parts, it also joins those whose joint outline is open enough. Each joined opening
/// is fitted again to its lines, which are those of `all`.
std::vector<Aperture> joined_in_planes(const FitInput& in, const Bundle& all,
                                       std::vector<Aperture> parts, size_t most);

}  // namespace tdpt
