// Distinguishes an opening from a plane in the air, or from one across several openings.
#pragma once
#include <optional>
#include <vector>

#include "tools/portalfit/aperture.h"

namespace tdpt {

/// Share of the grid's probes through the outline that join the two sides, over that of a perfect
/// opening of the same depth; nothing if there are too few.
std::optional<double> support_of(const FitInput& in, const Aperture& a);

/// Share of the outline that is an edge: a wall stands there, and half the aperture's size before
/// it or behind it, whichever has more, the air goes on past it. So it is around an opening into a
/// room; around a plane across a corridor or a long room the same walls go on, and around one in
/// the open there are none. Nothing if all of the grid is air, as in tables without it, or it is
/// too coarse.
std::optional<double> edge_share(const FitInput& in, const Aperture& a);

/// A plane before two windows at a corner lies in the open: most light of each window goes to one
/// side of its normal. Returns the densest opening, among all `lines`, of those that go to one side
/// of `whole`; nothing if none is denser than it.
std::optional<Aperture> part_of_directions(const FitInput& in, const Bundle& lines,
                                           const Aperture& whole);

}  // namespace tdpt
