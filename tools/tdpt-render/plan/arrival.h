// How often each kind of light is chosen, by what of it arrives where the camera looks: the sky
// outside a closed house is worth what comes in through its windows.
//
// Method: samples of `nee`, thrown away, add up what emitters, lamps, parallel light and the sky
// bring. Each kind then keeps a tenth of its share by power, so that nothing that shines is missed
// because these samples did not find it, and has the rest by what it brings.
#pragma once
#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/integrators/passes.h"

namespace tdpt {

/// Measured with the portals that `world` has now; those by power where nothing arrives.
Lights::Shares arriving_shares(const World& world, const SampleRules& rules);

}  // namespace tdpt
