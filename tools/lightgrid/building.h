// What the grid keeps of the building: the voxels free of geometry, the directions in which its
// walls face, and the sheets of solid glass in its windows.
#pragma once
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// "Air" in section 4.2, by conservative voxelisation of the triangles with the separating-axis
/// test. Sets grid.air to 1 where no triangle of the scene touches the voxel, 0 elsewhere.
/// Conservative: a triangle that only touches the voxel's boundary counts, too.
void mark_air(const Scene& scene, LightGrid& grid);

/// Whether a triangle touches the axis-aligned box with half side lengths `half` around the origin
/// (separating axes, Akenine-Moeller 2001).
bool triangle_touches_box(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& half);

/// Normals, of one of both sides, that at least 2 % of the surface in the grid's box has within two
/// degrees: of walls, floors and roofs, not of round or grown things. The most surface first; then
/// those at right angles to two of them.
std::vector<Vec3d> wall_directions(const Scene& scene, const LightGrid& grid);

/// Solids of glass between two parallel planes that are less than half as thick as wide; glass that
/// is curved or a sheet without thickness is none. The largest first, at most kMostPanes. Faces
/// must point out of the glass.
std::vector<GridPane> solid_panes(const Scene& scene);

}  // namespace tdpt
