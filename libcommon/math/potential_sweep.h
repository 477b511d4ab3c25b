// Who reaches a patch better, the light or the camera, and the sweep cuts in that order.
//
// The potential u of a patch is 0 where the light reaches it well and 1 where the camera does;
// between, that of a network of resistors whose conductances are the capacities of the arcs.
#pragma once
#include <algorithm>
#include <vector>

#include "libcommon/math/cut_facts.h"

namespace tdpt {

/// Nodes in the order of their potential, and the sweep cut behind each of them.
struct Sweep {
  std::vector<uint32_t> order;
  std::vector<double> u;         ///< of each node of the network
  std::vector<double> area;      ///< up to and with this node [samples of etendue]
  std::vector<double> volume;    ///< likewise, capacity that leaves for other patches
  std::vector<double> viewed;    ///< likewise, hits of the camera's walks; without a sky 0
  std::vector<double> crossing;  ///< capacity between it and those before, and those behind

  size_t size() const { return order.size(); }
  /// Of one of the sums, the part of the nodes low .. high (exclusive).
  static double between(const std::vector<double>& sum, size_t low, size_t high) {
    return (high == 0 ? 0 : sum[high - 1]) - (low == 0 ? 0 : sum[low - 1]);
  }
  /// Of the cut behind node `at` - 1, in the part low .. high of the sweep; 1 where a side is
  /// empty.
  double conductance(size_t at, size_t low, size_t high) const {
    const double smaller = std::min(between(volume, low, at), between(volume, at, high));
    return smaller > 0 ? crossing[at - 1] / smaller : 1;
  }
};

Sweep sweep_of(const PatchNetwork& problem);

/// Data terms of the patches, as in image segmentation: min(1, E_i / (0.5 E_med)) with E_i = hits_i
/// / samples_i and E_med its median weighted by hits; 0 for patches without samples.
std::vector<double> terminal_grades(const std::vector<double>& hits,
                                    const std::vector<double>& samples);

}  // namespace tdpt
