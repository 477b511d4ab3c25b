// An opening through which lines pass, and how to find it: the fullest voxel, the lines around it,
// the plane of their waist, the least tube there, the hull of the crossings within it.
#pragma once
#include <optional>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "tools/portalfit/lines.h"
#include "tools/portalfit/opening.h"
#include "tools/portalfit/plane.h"

namespace tdpt {

struct Aperture {
  Tube tube;
  Polygon polygon;  ///< in the middle plane of the tube [metres]
  Bundle lines;     ///< those that cross it along the normal
};

/// Of its outline, in space [metres].
std::vector<Vec3d> corners_of(const Aperture& a);

/// Those of `lines` that cross the aperture along its normal.
Bundle lines_across(const Bundle& lines, const Aperture& a);

/// Whether strays may be among the crossings of an outline, or all are known to belong to the
/// opening. Where a gap narrows to nothing few lines pass, and light that misses its portal costs a
/// render more than a portal that is slightly too large.
enum class Strays { some, none };
/// The convex outline of an opening with these crossings; empty if there is none.
Polygon outline_of(std::vector<Vec2d> points, Strays strays = Strays::some);

/// The aperture among `lines` close to `tube`, with its tube and outline. `again`: `tube` is the
/// result of an earlier fit.
std::optional<Aperture> outlined(const LightGrid& grid, const Bundle& lines, const Tube& tube,
                                 bool again = false);

/// The aperture around the fullest voxel of `lines`.
std::optional<Aperture> find_aperture(const LightGrid& grid, const Bundle& lines);

// Distinguishes an opening from a plane in the air, or from one across several openings.

/// Share of the grid's probes through the outline that join the two sides, over that of a perfect
/// opening of the same depth; nothing if there are too few.
std::optional<double> support_of(const LightGrid& grid, const Aperture& a);

/// Share of the outline that is an edge: a wall stands there, and half the aperture's size before
/// it or behind it, whichever has more, the air goes on past it. So it is around an opening into a
/// room; around a plane across a corridor or a long room the same walls go on, and around one in
/// the open there are none. Nothing if all of the grid is air, as in tables without it, or it is
/// too coarse.
std::optional<double> edge_share(const LightGrid& grid, const Aperture& a);

/// A plane before two windows at a corner lies in the open: most light of each window goes to one
/// side of its normal. Returns the densest opening, among all `lines`, of those that go to one side
/// of `whole`; nothing if none is denser than it.
std::optional<Aperture> part_of_directions(const LightGrid& grid, const Bundle& lines,
                                           const Aperture& whole);

}  // namespace tdpt
