// An opening through which lines pass: the tube that it cuts into its wall, its outline, and its
// neighbours.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/vec.h"
#include "tools/portalfit/lines.h"
#include "tools/portalfit/plane.h"

namespace tdpt {

// ---- The tube (opening.cpp) ----
//
// An opening with outline P in a wall of thickness t passes the lines that cross P on both faces.
// Position, orientation and thickness of the wall are found as the tube of least etendue that still
// holds nearly all lines. In thin walls a wrong tilt shows in the area, which grows with the lines'
// slant; in thick ones it shows in the outlines of the two faces, which no longer coincide.

/// Form factor between two equal rectangles a x b that face each other at the distance c >= 0:
/// Howell, Menguc, configuration C-11. 1 for c = 0.
double facing_rectangles(double a, double b, double c);

/// The tube of least etendue near `start` that holds `lines`. Each of the 16 sides of its outline
/// leaves 0.06 % of the crossings outside; lines that miss the tube altogether are penalised.
/// `near`: `start` is the result of an earlier search with nearly the same lines.
Tube least_tube(const std::vector<LightLine>& lines, const Tube& start, bool near);

/// The tube moved and turned into one of the walls that face nearly as it does; as it is if they
/// hold `lines` in clearly more etendue. Lines that come from one side leave the tilt nearly open,
/// and openings lie in walls.
Tube turned_into_wall(const std::vector<LightLine>& lines, const Tube& tube,
                      std::span<const Vec3d> walls);

/// The plane of least area near that of `start`, for lines that are known to pass there: missing
/// lines are penalised more.
Tube holding_plane(const std::vector<LightLine>& lines, const Tube& start);

// ---- The outline (outline.cpp) ----
//
// It is found from the fullest voxel, the lines around it, the plane of their waist, the least tube
// there, and the hull of the crossings within it.

struct Aperture {
  Tube tube;
  Polygon polygon;  ///< in the middle plane of the tube [metres]
  Bundle lines;     ///< those that cross it along the normal
};

/// The corners of its outline, in space [metres].
std::vector<Vec3d> corners_of(const Aperture& a);

/// Those of `lines` that cross the aperture along its normal.
Bundle lines_across(const Bundle& lines, const Aperture& a);

/// The convex outline of an opening with these crossings, without strays; empty if there is none.
Polygon outline_of(std::vector<Vec2d> points);

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

// ---- Neighbours (neighbours.cpp) ----
//
// Panes and gaps in one plane are joined into one opening with bars in it, and outlines that the
// light of another opening extends are cut back.

/// Joint geometry of flat shapes.
struct Joint {
  Plane plane;        ///< least squares to all corners, along the mean normal
  Polygon outline;    ///< convex, around all of them
  double open = 0;    ///< share of the outline that the shapes leave open
  bool flat = false;  ///< whether they lie in that plane
};
Joint joint_of(const LightGrid& grid, const std::vector<Aperture>& parts);

/// The least distance between two convex outlines in one plane; 0 if they touch.
double distance_between(const Polygon& a, const Polygon& b);

/// Joins openings in one plane across bars as thin as the grid resolves, and across mullions if
/// most of the joint outline is open; not across the pier between two windows. While there are more
/// than `most` parts, it also joins those whose joint outline is open enough. Each joined opening
/// is fitted again to its lines, which are those of `all`.
std::vector<Aperture> joined_in_planes(const LightGrid& grid, const Bundle& all,
                                       std::vector<Aperture> parts, size_t most);

/// For openings side by side, such as the slit beside a door and the gap above it: light through
/// the second crosses the plane of the first beyond its edge and extends its outline there. So each
/// is outlined again by the lines that do not cross the others, at first with the others enlarged,
/// and stays as it is if it would lose more than few of its lines. All lines are those of `all`.
void part_from_each_other(const LightGrid& grid, const Bundle& all, std::vector<Aperture>& found);

}  // namespace tdpt
