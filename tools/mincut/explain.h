// What --explain says of the cuts of a network: each that was kept or refused, with its figures
// against the limits, and where the search ended.
#pragma once
#include "libcommon/base/phases.h"
#include "libcommon/cli/decision.h"
#include "tools/mincut/cut_of.h"

namespace tdpt {

/// `most`: cuts that were asked for. Of the phases `flow` counts.
cli::Decisions decisions_of(const FoundCuts& found, size_t most, const CutLimits& limits,
                            const Phases& phases);

}  // namespace tdpt
