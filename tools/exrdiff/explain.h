// What --explain says of a comparison.
#pragma once
#include "libcommon/cli/decision.h"
#include "tools/exrdiff/measure.h"

namespace tdpt {

/// `without_data`: pixels of either file that count as black. `output`: where the difference goes;
/// empty: nowhere.
cli::Decisions decisions_of(const Comparison& comparison, const Picture& reference,
                            int64_t without_data, const std::string& output);

}  // namespace tdpt
