// How often each kind of light is to be chosen, where a sky stands beside other lights: by what
// arrives of it. By power alone a sky outranks every lamp indoors.
#pragma once
#include <utility>
#include <vector>

#include "tools/tdpt-render/path/sample/path.h"

namespace tdpt {

/// Adds up what paths bring of each kind of light.
class ArrivingLight {
 public:
  /// A path of its samples and its weighted luminance. That a light is seen needs no choice: it
  /// does not count.
  void see(const Path& path, double light);
  void merge(const ArrivingLight& other);
  /// Shares that add up to 1: nine tenths by what arrived, a tenth `by_power`, which all
  /// is where nothing arrived. One path tells at most a tenth of all.
  Lights::KindProbabilities shares(const Lights::KindProbabilities& by_power) const;

 private:
  std::vector<std::pair<const LightSource*, double>> found_;
};

}  // namespace tdpt
