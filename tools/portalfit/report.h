// What a plain run says of the portals that it found, a line each.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/portal.h"

namespace tdpt {

/// "3 portals: portal.0 0.69 m2, ..."; of many only the first are named.
/// There is at least one; each has its figures.
std::string portals_sentence(const std::vector<Portal>& portals);

}  // namespace tdpt
