// An opening that lines pass, and how it is found among them: the fullest place, the lines around
// it, the plane of their waist, the least tube there, the hull of the places within it.
#pragma once
#include <optional>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "tools/portalfit/bundle.h"
#include "tools/portalfit/polygon.h"
#include "tools/portalfit/tube.h"

namespace tdpt {

/// With fewer lines nothing is said about an opening.
inline constexpr size_t kFewestLines = 30;

struct Aperture {
  Tube tube;
  Polygon polygon;  ///< in the middle of the tube [metres]
  Bundle lines;     ///< that cross it along the normal
};

/// Those of `lines` that cross the aperture along its normal.
Bundle lines_across(const Bundle& lines, const Aperture& a);

/// The convex outline of an opening with these crossings, but for strays; empty when there is none.
Polygon outline_of(std::vector<Vec2d> points);

/// The same for crossings that are known to belong there: none is a stray. In few corners, by which
/// it grows. Where a gap narrows to nothing few lines pass, and light that misses its portal costs
/// a render more than a portal that is a little too large.
Polygon whole_outline(const std::vector<Vec2d>& points);

/// The aperture among `lines` close to `tube`: its tube, its outline. `voxel`: side of the grid's
/// [metres]; `again`: it is one already.
std::optional<Aperture> outlined(const Bundle& lines, const Tube& tube, double voxel,
                                 bool again = false);

/// The aperture around the fullest place of `lines`.
std::optional<Aperture> find_aperture(const LightGrid& grid, const Bundle& lines);

}  // namespace tdpt
