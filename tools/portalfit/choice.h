// Portals that are not written unless asked for.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"

namespace tdpt {

/// Conductance of open space: share of the smaller side's light across the cut. Half of a room that
/// is twice as long as wide and high has a fifth.
inline constexpr double kOpenSpace = 0.2;

/// For each portal the reason why it is certainly useless, as a sentence without its full stop;
/// empty if it may be useful. From the conductance of portal(5); a
/// missing figure proves nothing, and neither does tightness, which is small in a keyhole, too.
std::vector<std::string> why_useless(const std::vector<Portal>& portals);

}  // namespace tdpt
