// The text of --explain for fitted portals: each that is written or refused, with its figure and
// the limit.
#pragma once
#include "libcommon/base/phases.h"
#include "libcommon/cli/decision.h"
#include "tools/portalfit/portalfit.h"

namespace tdpt {

/// Of the phases only `fit` is used.
cli::Decisions decisions_of(const LightGrid& grid, const PortalFitOptions& options,
                            const FitResult& found, const Phases& phases);

}  // namespace tdpt
