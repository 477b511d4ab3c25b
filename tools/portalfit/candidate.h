// Distinguishes an opening from a plane in the air, or from one across several openings.
#pragma once
#include <optional>
#include <vector>

#include "tools/portalfit/aperture.h"

namespace tdpt {

/// Share of the grid's probes through the outline that join the two sides, over that of a perfect
/// opening of the same depth; nothing if there are too few.
std::optional<double> support_of(const FitInput& in, const Aperture& a);

/// How much wider the light of the aperture is half its size before it and behind it, over its
/// width there: the larger of the two ratios of areas. Where light passes a wall it widens on one
/// side at least; across a long room, where a plane bounds nothing, it does not. Nothing if hardly
/// a line goes so far. Lines from outside the grid come from far away.
std::optional<double> widening_of(const FitInput& in, const Aperture& a);

/// A plane across several openings, such as the sides of a bay, has little support and fewer of the
/// `lines` per area than one of them. Returns that one; nothing if there is none.
std::optional<Aperture> denser_part(const FitInput& in, const Bundle& lines, const Aperture& whole);

/// A plane before two windows at a corner lies in the open: most light of each window goes to one
/// side of its normal. Returns the densest opening, among all `lines`, of those that go to one side
/// of `whole`; nothing if none is denser than it.
std::optional<Aperture> part_of_directions(const FitInput& in, const Bundle& lines,
                                           const Aperture& whole);

}  // namespace tdpt
