// What a scene uses of all that a scene may hold, and what is therefore left out: for --explain.
#pragma once
#include <string_view>
#include <vector>

#include "libcommon/cli/decision.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// The words of Scene::needs, in its order.
std::vector<std::string_view> all_needs();

/// A decision for each of `words`: a tool names those that it would have work with.
cli::Decisions uses_of(const Scene& scene, const std::vector<std::string_view>& words);

}  // namespace tdpt
