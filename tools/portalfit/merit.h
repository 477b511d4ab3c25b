// Figures of merit of fitted portals, from the grid to which they were fitted.
#pragma once
#include <optional>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/formats/portal.h"
#include "tools/portalfit/plane.h"

namespace tdpt {

/// A line that crosses a portal along its normal.
struct LineCrossing {
  uint32_t line;
  Vec2d at;  ///< in the plane of the portal's shape
};

/// Share of a portal's lines that pass from one side to the other; nothing if none crosses.
/// `crossings`: of one cut, by index into `lines`.
std::optional<double> tightness_of(const std::vector<LightLine>& lines, const PortalShape& shape,
                                   const std::vector<LineCrossing>& crossings);

/// Adds figures of portal(5) to each portal: `cut` (the one that has the largest share of its lines
/// cross the portal), `tightness` (share of the lines through the portal that pass from one side to
/// the other: positions uniform, directions cosine-distributed), and `conductance` if the grid
/// knows its cuts (of the cut, as far as its lines cross its portals), and `sky` (share of the
/// portal's lines that come from outside the grid and pass no other portal before it; left out if
/// the grid names no scene or does not tell air from walls, as tables).
void appraise(const LightGrid& grid, std::vector<Portal>& portals);

}  // namespace tdpt
