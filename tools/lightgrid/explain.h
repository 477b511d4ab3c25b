// What --explain says about a light grid: where it lies, when its counts settled, which lines it
// kept.
#pragma once
#include <string>

#include "libcommon/cli/decision.h"
#include "tools/lightgrid/lightgrid.h"

namespace tdpt {

/// `device`: what traced the lines.
cli::Decisions decisions_of(const Scene& scene, const LightGrid& grid,
                            const LightGridOptions& options, const LightGridReport& report,
                            const std::string& device);

}  // namespace tdpt
