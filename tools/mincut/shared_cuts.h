// The cuts of several cameras as one list: openings that several of them look through occur once.
//
// Cameras are cut one by one and not as one sink of all: a lamp in room B that lights room A
// through their door would lose that door as soon as a camera stands in B, too.
#pragma once
#include <cstdint>
#include <vector>

#include "libcommon/math/series_cut.h"

namespace tdpt {

struct SharedCut {
  std::vector<uint8_t> source_side;  ///< per node
  int64_t flow = 0;                  ///< of the narrowest, as are the facts
  CutFacts facts;
  std::vector<uint32_t> cameras;  ///< that it serves, ascending
};

/// The bottlenecks that were found for each camera, camera by camera; without any, the first
/// camera's cut. Two are one if of the light that crosses either, by what it means to the one
/// camera and to the other, limits.same_opening crosses both; then the narrower one stands for
/// both. `networks`: of each camera, with the same patches as nodes.
std::vector<SharedCut> shared_cuts(const std::vector<PatchNetwork>& networks,
                                   const std::vector<SeriesCut>& series, const CutLimits& limits);

/// Leaves at most `most` of them, in their order: those that serve most cameras, and of these those
/// that promise most.
void keep_most_promising(std::vector<SharedCut>& cuts, size_t most);

}  // namespace tdpt
