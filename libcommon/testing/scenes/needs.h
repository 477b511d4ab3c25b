// The features that a scene needs of a renderer, by the words that --explain says.
#pragma once
#include <string>
#include <vector>

#include "libcommon/scene/uses.h"

namespace tdpt::testing {

inline std::vector<std::string> needs_of(const Scene& scene) {
  std::vector<std::string> words;
  for (const cli::Decision& d : uses_of(scene, all_needs()))
    if (d.chosen == "used") words.push_back(d.what);
  return words;
}

}  // namespace tdpt::testing
