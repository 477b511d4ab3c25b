// Reads scenes of pbrt-v3 and pbrt-v4.
#pragma once
#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/source.h"

namespace tdpt::foreign {

/// The version is told from the scene's directives and materials. Throws InputError.
Described read_pbrt(Source& source);

}  // namespace tdpt::foreign
