// How often each kind of light is selected when there is a sky beside other lights: in proportion
// to the light that arrives from it. By power alone a sky would outrank every lamp indoors.
#pragma once
#include <utility>
#include <vector>

#include "tools/tdpt-render/path/sample/path.h"

namespace tdpt {

/// Sums the contribution of each kind of light.
class ArrivingLight {
 public:
  /// A path and its weighted luminance. Directly seen lights are ignored: no selection was needed.
  void see(const Path& path, double light);
  void merge(const ArrivingLight& other);
  /// Selection probabilities, which sum to 1: nine tenths by what arrived, one tenth `by_power`;
  /// all `by_power` if nothing arrived. A single path counts for at most a tenth of the total.
  Lights::KindProbabilities shares(const Lights::KindProbabilities& by_power) const;

 private:
  std::vector<std::pair<const LightSource*, double>> found_;
};

}  // namespace tdpt
