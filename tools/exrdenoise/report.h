// What exrdenoise says about a filtered picture.
#pragma once
#include <optional>
#include <string>

#include "libcommon/cli/cli.h"
#include "libcommon/denoise/filter_picture.h"

namespace tdpt {

/// One JSON object, the keys of exrdenoise(1). `exposure`: of the preview, if there is one.
std::string summary_json(const Picture& picture, const denoise::Filtered& filtered, double seconds,
                         std::optional<double> exposure);

cli::Decisions decisions_of(const denoise::Filtered& filtered);

}  // namespace tdpt
