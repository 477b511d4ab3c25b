// The directions in which a building's walls face.
#pragma once
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// Normals, of one of both sides, that at least 2 % of the surface in the grid's box has within two
/// degrees: of walls, floors and roofs, not of round or grown things. The most surface first; then
/// those at right angles to two of them.
std::vector<Vec3d> wall_directions(const Scene& scene, const LightGrid& grid);

}  // namespace tdpt
