// How narrow the way through a portal is, measured by rays: for portals that come without figures,
// as those drawn by hand.
//
// Method: conductance of the room's random walk (Cheeger), by Monte Carlo: diffuse walks that begin
// in the portal; the share of their bounces whose next edge goes back through it.
#pragma once
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// Share of the diffuse bounces on either side of the portal whose next edge crosses it: of the
/// side where they are more. In a closed room it is the area of the opening to that of the room's
/// surface, the conductance of cut(5). Some ten thousand rays; a function of its arguments alone.
double probed_conductance(const World& world, const Portal& portal);

}  // namespace tdpt
