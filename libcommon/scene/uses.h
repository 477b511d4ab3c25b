// For --explain: which features a scene uses, and what is therefore left out.
#pragma once
#include <string_view>
#include <vector>

#include "libcommon/cli/cli.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// Words for all features, in order.
std::vector<std::string_view> all_needs();

/// A decision for each of `words`: a tool lists those that would cause it work.
cli::Decisions uses_of(const Scene& scene, const std::vector<std::string_view>& words);

}  // namespace tdpt
