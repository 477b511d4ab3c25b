// Finds the voxels that are free of geometry, "Air" in section 4.2: conservative voxelisation of
// the triangles by the separating-axis test.
#pragma once
#include "libcommon/formats/light_grid.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// Sets grid.air to 1 where no triangle of the scene touches the voxel, 0 elsewhere. Conservative:
/// a triangle that only touches the voxel's boundary counts, too.
void mark_air(const Scene& scene, LightGrid& grid);

/// Whether a triangle touches the axis-aligned box with half side lengths `half` around the origin
/// (separating axes, Akenine-Moeller 2001).
bool triangle_touches_box(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& half);

}  // namespace tdpt
