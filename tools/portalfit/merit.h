// What fitted portals are worth, from the grid that they were fitted to.
#pragma once
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/formats/portal.h"

namespace tdpt {

/// Adds figures of portal(5) to each portal: `cut` (the one most of whose lines cross it),
/// `tightness` (share of its lines that pass from one side to the other: places uniform on it,
/// directions cosine-distributed), and where the grid knows its cuts `conductance` (of the cut,
/// as far as lines cross its portals).
void appraise(const LightGrid& grid, std::vector<Portal>& portals);

}  // namespace tdpt
