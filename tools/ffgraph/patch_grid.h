// The size of patches: chosen by the region that walks reach, not by the scene's bounding box,
// which a ground or a sky may make a hundred times as large as the rooms.
#pragma once
#include "tools/ffgraph/patch_map.h"
#include "tools/ffgraph/walks.h"

namespace tdpt {

struct GridOfWalks {
  PatchGrid grid;
  FineRegion fine;
};

/// Cells of (diagonal of the region) / `cells` in and around the region, of several cameras the
/// median of theirs, at least half as large as for all; outside 4 times as large, or 16 times and
/// so on, if the scene is that much larger than the region. The region contains most hits of light
/// walks and most of each camera's walks (reach.h); only those of camera walks if light comes from
/// infinity.
GridOfWalks grid_for(const Scene& scene, const Walks& light, const std::vector<Walks>& cameras,
                     double cells);

}  // namespace tdpt
