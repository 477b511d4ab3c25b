// How large patches are: by the region that walks reach, not by the scene's bounding box, which a
// ground or a sky may make a hundred times as large as the rooms.
#pragma once
#include "tools/ffgraph/patch_map.h"
#include "tools/ffgraph/walks.h"

namespace tdpt {

struct GridOfWalks {
  PatchGrid grid;
  FineRegion fine;
};

/// Cells of (diagonal of the region) / `cells` in the region and around it, four times as large, or
/// 16 times and so on, beyond where the scene is that much larger than the region. The region:
/// where most hits of the light's walks are, and where most of the camera's (reach.h); the camera's
/// alone where light comes from infinity.
GridOfWalks grid_for(const Scene& scene, const Walks& light, const Walks& camera, double cells);

}  // namespace tdpt
