// What fitted portals are worth, from the grid that they were fitted to.
#pragma once
#include <optional>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/formats/portal.h"
#include "tools/portalfit/polygon.h"
#include "tools/portalfit/portal_shape.h"

namespace tdpt {

/// A line that crosses a portal along its normal.
struct LineCrossing {
  uint32_t line;
  Vec2d at;  ///< in the plane of the portal's shape
};

/// Share of a portal's lines that pass from one side to the other; nothing when none crosses.
/// `crossings`: of one cut, by the grid's `lines`.
std::optional<double> tightness_of(const std::vector<LightLine>& lines, const PortalShape& shape,
                                   const std::vector<LineCrossing>& crossings);

/// Adds figures of portal(5) to each portal: `cut` (the one most of whose lines cross it),
/// `tightness` (share of its lines that pass from one side to the other: places uniform on it,
/// directions cosine-distributed), and where the grid knows its cuts `conductance` (of the cut,
/// as far as lines cross its portals).
void appraise(const LightGrid& grid, std::vector<Portal>& portals);

}  // namespace tdpt
