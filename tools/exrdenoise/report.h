// What exrdenoise says about a filtered picture.
#pragma once
#include <string>

#include "libcommon/cli/decision.h"
#include "libcommon/denoise/filter_picture.h"

namespace tdpt {

/// One JSON object, the keys of exrdenoise(1).
std::string summary_json(const Picture& picture, const denoise::Filtered& filtered, double seconds);

cli::Decisions decisions_of(const denoise::Filtered& filtered);

}  // namespace tdpt
