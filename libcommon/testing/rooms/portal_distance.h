// Distance between portals.
#pragma once
#include <vector>

#include "libcommon/formats/portal.h"

namespace tdpt::testing {

/// Hausdorff distance of two convex portals [metres]: no point of one is farther from the other.
double distance(const Portal& a, const Portal& b);

/// Distance to the nearest of `others`; infinite if there is none.
double distance_to_nearest(const Portal& portal, const std::vector<Portal>& others);

}  // namespace tdpt::testing
