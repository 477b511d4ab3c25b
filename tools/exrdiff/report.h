// The output of exrdiff.
#pragma once
#include <string>

#include "libcommon/cli/cli.h"
#include "tools/exrdiff/measure.h"

namespace tdpt {

/// For people: one measure a line, the black picture's beside it.
std::string report_text(const Comparison& c);
/// One JSON object; the keys are listed in exrdiff(1). An infinite psnr is null.
std::string report_json(const Comparison& c);

/// For --explain. `without_data`: pixels of either file that count as black. `output`: path of the
/// difference; empty: none.
cli::Decisions decisions_of(const Comparison& comparison, const Picture& reference,
                            int64_t without_data, const std::string& output);

}  // namespace tdpt
