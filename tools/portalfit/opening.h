// The tube that an opening cuts into its wall: a prism that contains all its lines.
//
// An opening with outline P in a wall of thickness t passes the lines that cross P on both faces.
// Position, orientation and thickness of the wall are found as the tube of least etendue that still
// holds nearly all lines. In thin walls a wrong tilt shows in the area, which grows with the lines'
// slant; in thick ones it shows in the outlines of the two faces, which no longer coincide.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/vec.h"
#include "tools/portalfit/lines.h"

namespace tdpt {

/// Form factor between two equal rectangles a x b that face each other at the distance c >= 0:
/// Howell, Menguc, configuration C-11. 1 for c = 0.
double facing_rectangles(double a, double b, double c);

/// The tube of least etendue near `start` that holds `lines`. Each of the 16 sides of its outline
/// leaves 0.06 % of the crossings outside; lines that miss the tube altogether are penalised.
/// `near`: `start` is the result of an earlier search with nearly the same lines.
Tube least_tube(const std::vector<LightLine>& lines, const Tube& start, bool near);

/// The tube moved and turned into one of the walls that face nearly as it does; nothing if they
/// hold `lines` in clearly more etendue. Lines that come from one side leave the tilt nearly open,
/// and openings lie in walls.
std::optional<Tube> tube_in_wall(const std::vector<LightLine>& lines, const Tube& tube,
                                 std::span<const Vec3d> walls);

/// The plane of least area near that of `start`, for lines that are known to pass there: missing
/// lines are penalised more.
Tube holding_plane(const std::vector<LightLine>& lines, const Tube& start);

}  // namespace tdpt
