// What tells an opening from a plane in the air, or from one across several openings.
#pragma once
#include <optional>
#include <vector>

#include "tools/portalfit/aperture.h"

namespace tdpt {

/// Share of the `probes` through the outline that join the two sides, over that of a perfect
/// opening as deep; nothing when they are too few to tell.
std::optional<double> support_of(const std::vector<Probe>& probes, const Aperture& a);

/// Tightness of the aperture (merit.h) over that of a perfect opening as deep. In open air, where
/// no edge bounds the light, lines thin out towards the border and away from the mean direction.
double fullness_of(const Aperture& a);

/// Lines to the etendue of a perfect opening like it [1/(m2 pi)]. Lines are uniform by etendue, so
/// this is the same for all openings of a cut but for what stands in them.
double density_of(const Aperture& a);

/// What lies across several openings, as the sides of a bay, has little support and fewer of the
/// `lines` to its area than one of them: that one. Nothing when there is none.
std::optional<Aperture> denser_part(const LightGrid& grid, const Bundle& lines,
                                    const Aperture& whole);

/// A plane before two windows at a corner lies in the open: most of the light of each goes to one
/// side. The densest opening, among all `lines`, of those that go to one side of `whole`. Nothing
/// where none is denser than it.
std::optional<Aperture> part_of_directions(const LightGrid& grid, const Bundle& lines,
                                           const Aperture& whole);

/// The densest opening of lines that go about the same way: where the windows of several walls are
/// and the light of all has no common waist.
std::optional<Aperture> aperture_of_directions(const LightGrid& grid, const Bundle& lines);

}  // namespace tdpt
