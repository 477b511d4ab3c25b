// The cuts of one of several cameras in a network that all share.
#pragma once
#include "libcommon/math/series_cut.h"

namespace tdpt {

/// series_cut() in the part of the network that the light's walks or this camera's hit: what a
/// network of this camera alone would hold, so that rooms of other cameras neither cost time nor
/// count as a side of a cut. Other nodes then get the region to which most of their capacity leads,
/// or that of the light. `whole` must know the hits.
SeriesCut camera_cut(const PatchNetwork& whole, size_t most, const CutLimits& limits,
                     const FlowCheck& check = {});

}  // namespace tdpt
