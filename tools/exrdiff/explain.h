// The text of --explain for a comparison.
#pragma once
#include "libcommon/cli/decision.h"
#include "tools/exrdiff/measure.h"

namespace tdpt {

/// `without_data`: pixels of either file that count as black. `output`: path of the difference;
/// empty: none.
cli::Decisions decisions_of(const Comparison& comparison, const Picture& reference,
                            int64_t without_data, const std::string& output);

}  // namespace tdpt
