// The paper's rule (section 4.3), for comparison: the normal is the main principal axis (PCA) of
// the full voxels; those that the plane through the fullest of them intersects are projected onto
// it, and the outline is their hull. Ours are the threshold of a full voxel, half the largest
// count, since the paper gives none, and the side that the front faces.
#pragma once
#include <optional>

#include "libcommon/formats/light_grid.h"
#include "libcommon/formats/portal.h"

namespace tdpt {

/// Principal axes of the centres of the voxels with at least `share` of the fullest one's count.
struct VoxelAxes {
  std::vector<Vec3d> centres;     ///< metres
  Vec3d mean{}, main{}, minor{};  ///< unit axes; zero when there are no voxels
};
VoxelAxes axes_of_full_voxels(const LightGrid& grid, double share);

struct PaperPortal {
  Portal portal;
  std::vector<uint32_t> lines;  ///< that cross it along its normal, as indices into grid.lines
};
/// One portal, whose front is turned the way the light goes. Nothing if the centres of the voxels
/// make no polygon.
std::optional<PaperPortal> portal_by_paper(const LightGrid& grid);

}  // namespace tdpt
