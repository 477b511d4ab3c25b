// The tube an opening makes of its wall: a prism that all its lines keep within.
//
// An opening with outline P in a wall of thickness t lets through the lines that pass P on both
// faces. Where the wall stands, how it is turned and how thick it is, is found by looking for the
// tube of least etendue that still holds nearly all lines. In thin walls a wrong tilt shows in the
// area, which grows with the lines' slant; in thick ones it shows in the outlines of the two faces,
// which no longer cover each other.
#pragma once
#include <optional>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/vec.h"
#include "tools/portalfit/bundle.h"

namespace tdpt {

/// Form factor between two equal rectangles a x b that face each other at the distance c >= 0:
/// Howell, Menguc, configuration C-11. 1 for c = 0.
double facing_rectangles(double a, double b, double c);

/// The tube of least etendue near `start` that holds `lines`. Of 16 sides of its outline each
/// leaves 0.06 % of the lines outside; lines that miss it altogether are held against it. `near`:
/// `start` is a result of this already, for nearly the same lines.
Tube least_tube(const std::vector<LightLine>& lines, const Tube& start, bool near);

/// A tube near `tube` that holds `lines` within clearly less area, and less etendue; nothing when
/// there is none.
std::optional<Tube> lesser_tube(const std::vector<LightLine>& lines, const Tube& tube);

/// The plane of least area near that of `start`, where few of `lines` may miss it: for lines that
/// are known to pass there.
Tube holding_plane(const std::vector<LightLine>& lines, const Tube& start);

}  // namespace tdpt
