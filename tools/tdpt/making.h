// Makes what a request asks for: portals if there are none yet, the picture, its report. Results
// that exist and are up to date are kept.
#pragma once
#include <set>
#include <string>

#include "tools/tdpt/request.h"

namespace tdpt {

/// Returns the exit code. Throws Error for what is wrong before a program runs.
int make(const Arguments& a, const cli::Common& common);

/// The commands that make() would run, for a shell. `printed`: entries of the cache whose commands
/// were printed before; it is added to.
std::string commands_of(const Arguments& a, const cli::Common& common,
                        std::set<std::string>& printed);

}  // namespace tdpt
