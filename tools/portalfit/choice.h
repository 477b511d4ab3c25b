// Which portals are not written unless asked for.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"

namespace tdpt {

/// All portals of a cut that carry less of its light together bring next to nothing.
inline constexpr double kLeastTogether = 0.1;
/// Of the smaller side's light, across the cut: half of a room that is twice as long as wide and
/// high has a fifth.
inline constexpr double kOpenSpace = 0.2;

/// For each portal why it is useless for certain, a sentence without its end; empty where it may be
/// of use. From the figures of portal(5): cut, flux_share and conductance; what is missing says
/// nothing. Tightness says nothing either: it is small in a keyhole, too.
std::vector<std::string> why_useless(const std::vector<Portal>& portals);

}  // namespace tdpt
