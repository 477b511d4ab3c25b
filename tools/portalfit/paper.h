// The paper's rule (section 4.3), for comparison: the normal is the main principal axis (PCA) of
// the full voxels, and the outline their hull.
#pragma once
#include <optional>

#include "libcommon/formats/light_grid.h"
#include "libcommon/formats/portal.h"
#include "tools/portalfit/limits.h"

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
/// One portal: the convex hull of the full voxels' centres, projected along their main axis, which
/// is turned the way the light goes. Nothing if they make no polygon.
std::optional<PaperPortal> portal_by_paper(const FitInput& in);

}  // namespace tdpt
