// Reads scenes of Mitsuba 0.4 to 0.6, 2 and 3 (XML).
#pragma once
#include <map>

#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/source.h"

namespace tdpt::foreign {

/// `parameters` replace `$name` and the scene's own defaults. Throws InputError.
Described read_mitsuba(Source& source, const std::map<std::string, std::string>& parameters);

}  // namespace tdpt::foreign
