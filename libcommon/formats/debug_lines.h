// The option that says how lines are drawn in the files of --debug-glb.
#pragma once
#include <string>

#include "libcommon/cli/cli.h"
#include "libcommon/formats/debug_glb.h"

namespace tdpt {

/// --set debug-lines.
void declare_debug_lines(cli::Options& options, std::string& value);

DebugLines debug_lines(const std::string& value);

}  // namespace tdpt
