// The text of --explain for the cuts of a network: each cut kept or refused, with its figures and
// their limits, and where the search ended.
#pragma once
#include "libcommon/base/phases.h"
#include "libcommon/cli/decision.h"
#include "tools/mincut/cut_of.h"

namespace tdpt {

/// `most`: number of cuts asked for. Of the phases only `flow` is used.
cli::Decisions decisions_of(const FoundCuts& found, size_t most, const CutLimits& limits,
                            const Phases& phases);

}  // namespace tdpt
