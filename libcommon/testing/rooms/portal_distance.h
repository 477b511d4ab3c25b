// How far apart two portals are.
#pragma once
#include <vector>

#include "libcommon/formats/portal.h"

namespace tdpt::testing {

/// Hausdorff distance of two convex portals [metres]: no place of one is farther from the other.
double distance(const Portal& a, const Portal& b);

/// Distance to the portal of `others` that is nearest; infinite when there is none.
double distance_to_nearest(const Portal& portal, const std::vector<Portal>& others);

}  // namespace tdpt::testing
