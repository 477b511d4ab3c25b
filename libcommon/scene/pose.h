// A moment of a scene's animations.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace tdpt {

struct Pose {
  std::optional<double> seconds{};        ///< none: not asked for, the beginning
  std::vector<std::string> animations{};  ///< names of those that are applied; none: all
  bool is_given() const { return seconds || !animations.empty(); }
};

struct AnimationFacts {
  std::string name;    ///< distinct
  double seconds = 0;  ///< time of its last key that moves something
};

}  // namespace tdpt
