// How narrow the way through a portal is, measured by rays, for portals without figures such as
// those drawn by hand.
//
// Method: conductance of the room's random walk (Cheeger), by Monte Carlo. Diffuse walks begin in
// the portal; the conductance is the share of their bounces whose next edge goes back through it.
#pragma once
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// Share of the diffuse bounces whose next edge crosses the portal, on the side where it is larger.
/// In a closed room it is the area of the opening over that of the room's surface, the conductance
/// of cut(5). Takes some ten thousand rays; a function of its arguments alone.
double probed_conductance(const World& world, const Portal& portal);

}  // namespace tdpt
