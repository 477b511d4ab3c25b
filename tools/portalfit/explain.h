// What --explain says of fitted portals: each that is written, left out or refused, with its figure
// against the limit.
#pragma once
#include "libcommon/base/phases.h"
#include "libcommon/cli/decision.h"
#include "tools/portalfit/portalfit.h"

namespace tdpt {

/// `useless`: of each portal why it is not written; empty where it is. Of the phases `fit` counts.
cli::Decisions decisions_of(const LightGrid& grid, const PortalFitOptions& options,
                            const FitResult& found, const std::vector<std::string>& useless,
                            const Phases& phases);

}  // namespace tdpt
