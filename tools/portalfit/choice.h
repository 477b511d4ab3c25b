// Portals that are not written unless asked for.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"
#include "tools/portalfit/limits.h"

namespace tdpt {

/// For each portal the reason why it is certainly useless, as a sentence without its full stop;
/// empty if it may be useful. From the conductance of portal(5); a
/// missing figure proves nothing, and neither does tightness, which is small in a keyhole, too.
std::vector<std::string> why_useless(const std::vector<Portal>& portals, const FitLimits& limits);

}  // namespace tdpt
