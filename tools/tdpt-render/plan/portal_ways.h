// Which way a portal works: with the light that reaches the camera, since a portal that faces the
// wrong way costs time and finds no light, and modelling programs do not show the way it faces. The
// light is that of a first look at the scene [exploration.h].
#pragma once
#include <array>
#include <vector>

#include "libcommon/formats/portal.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

enum class PortalWay {
  as_drawn,  ///< as its file says
  front,     ///< only from its back to its front
  back,      ///< only from its front to its back: turned round
  both,
  left_out  ///< no light passes it
};

/// The way in which a portal should work. `passed`: light along its normal and against it; `sure`:
/// the same without the brightest sample, 0 if fewer than 10 samples carried any; `total`: of the
/// whole picture; `wide`: whether is_wide(). As drawn if less than a thousandth of the light passed
/// either way for sure. Otherwise in each way that carries at least a fifth of its light: some
/// light always turns back, at the jambs of a thick wall or in the room behind, and segments that
/// way are wasted. Measured with tdpt-guided: keeping a way that carried 7 to 9 % (a hole of
/// 0.10 m, a window of 1.6 m) took 1.6 to 2 times the work for the same error. A wide portal works
/// one way, as drawn or else the way of the most light: across the middle of a room both ways took
/// 3 times the work of one.
PortalWay way_of(bool drawn_both_ways, const std::array<double, 2>& passed,
                 const std::array<double, 2>& sure, double total, bool wide);

/// Conductance of a portal without figures, such as one drawn by hand: the share of the diffuse
/// bounces whose next edge crosses it, on the side where it is larger. In a closed room it is the
/// area of the opening over that of the room's surface, the conductance of cut(5).
/// Method: conductance of the room's random walk (Cheeger), by Monte Carlo. Diffuse walks begin in
/// the portal; takes some ten thousand rays; a function of its arguments alone.
double probed_conductance(const World& world, const Portal& portal);
/// Whether its conductance is above 0.066.
bool is_wide(const World& world, const Portal& portal);

/// Makes each portal work its way; one that is left out keeps the figure of its area but no
/// triangles. Throws std::out_of_range for a portal that does not exist.
void apply_ways(const std::vector<PortalWay>& ways, std::vector<Portal>& portals);

}  // namespace tdpt
