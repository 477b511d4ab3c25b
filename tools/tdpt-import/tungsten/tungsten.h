// Reads scenes of Tungsten (JSON).
#pragma once
#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/source.h"

namespace tdpt::foreign {

/// Throws InputError.
Described read_tungsten(Source& source);

}  // namespace tdpt::foreign
