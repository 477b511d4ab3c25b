// The output of exrdiff.
#pragma once
#include <string>

#include "tools/exrdiff/measure.h"

namespace tdpt {

/// For people: one measure a line, the black picture's beside it.
std::string report_text(const Comparison& c);
/// One JSON object; the keys are listed in exrdiff(1). An infinite psnr is null.
std::string report_json(const Comparison& c);

}  // namespace tdpt
