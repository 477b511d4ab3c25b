// Orders patches by whether the light or the camera reaches them better, and makes sweep cuts in
// that order.
//
// The potential u of a patch is log(v / b), the ratio of what it means to the camera and of how
// bright it is: both are even within a room, and from room to room towards the camera b falls and v
// rises by a factor. A closet has the ratio of its room. Where they are unknown, the walks that hit
// a patch stand for them, or the terminals' arcs. It is smoothed and continued as the potential of
// a resistor network whose conductances are the arcs' capacities (random-walker segmentation).
#pragma once
#include <algorithm>
#include <vector>

#include "libcommon/flow/cut_facts.h"

namespace tdpt {

/// Nodes in order of potential, with the sweep cut after each of them.
struct Sweep {
  std::vector<uint32_t> order;
  std::vector<double> u;         ///< of each node of the network
  std::vector<SetSize> before;   ///< of all nodes before each, and of all
  std::vector<double> crossing;  ///< capacity across the cut after this node

  size_t size() const { return order.size(); }
  /// The size of nodes low .. high (exclusive).
  SetSize between(size_t low, size_t high) const { return before[high] - before[low]; }
  /// Conductance of the cut after node `at` - 1 within the part low .. high of the sweep; 1 if a
  /// side is empty.
  double conductance(size_t at, size_t low, size_t high) const {
    const double smaller = std::min(between(low, at).volume, between(at, high).volume);
    return smaller > 0 ? crossing[at - 1] / smaller : 1;
  }
};

Sweep sweep_of(const PatchNetwork& problem);

/// Unary terms of patches or of bins of the sky, as in image segmentation: min(1, E_i / (0.5
/// E_med)) with E_i = light_i / size_i and E_med its median, weighted; 0 for what has no light or
/// no size.
std::vector<double> terminal_grades(const std::vector<double>& light,
                                    const std::vector<double>& size,
                                    const std::vector<double>& weight);
/// Those of patches by their hits, weighted by hits.
inline std::vector<double> terminal_grades(const std::vector<double>& hits,
                                           const std::vector<double>& samples) {
  return terminal_grades(hits, samples, hits);
}

}  // namespace tdpt
