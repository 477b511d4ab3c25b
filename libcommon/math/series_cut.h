// Bottlenecks one behind the other: minimum cuts of a network of patches.
//
// The minimum cut finds the narrowest of several openings in series. Where the potential of a
// network of resistors (series_cut.cpp) shows more than one drop, there is a cut for each.
#pragma once
#include <functional>
#include <string>

#include "libcommon/math/max_flow.h"

namespace tdpt {

struct CutLimits {
  /// Share of the whole area that either side of a bottleneck must have.
  double least_area = 0.03;
  /// Conductance: capacity across the cut / capacity of all arcs that leave patches of the smaller
  /// side for other patches. A bottleneck's is at most this.
  double largest_conductance = 0.12;
};

/// A network whose nodes but two are patches of surface.
struct PatchNetwork {
  FlowNetwork network;
  std::vector<double> samples;  ///< of each node: its area [samples of etendue]; terminals: 0
  double scale = 1;             ///< capacity of one sample
};

struct SeriesCut {
  struct Cut {
    int64_t flow;        ///< its value, terminals included [units of the network]
    double conductance;  ///< of the whole network, parted here
  };
  /// In the light's order; at least one. Cut c parts the regions 0..c from those above c.
  std::vector<Cut> cuts;
  std::vector<uint32_t> region;  ///< of each node, 0 at the source, cuts.size() at the sink
  bool bottleneck = false;       ///< whether the cuts are bottlenecks; if not there is one cut
  std::string reason;            ///< a plain sentence, why not, when !bottleneck
};

/// Solves one maximum-flow problem; a caller may check the answer on its way.
using FlowSolver = std::function<MaxFlow(const FlowNetwork&)>;

/// At most `most` cuts. Where there is one drop of the potential or none, the minimum cut of the
/// network as it is, if that is a bottleneck. Of several each is cut by itself, and its terminals
/// draw patches by how far their potential lies from the drop.
SeriesCut series_cut(const PatchNetwork& problem, size_t most, const CutLimits& limits,
                     const FlowSolver& solve = max_flow);

/// Data terms of the patches, as in image segmentation: min(1, E_i / (0.5 E_med)) with E_i = hits_i
/// / samples_i and E_med its median weighted by hits; 0 for patches without samples.
std::vector<double> terminal_grades(const std::vector<double>& hits,
                                    const std::vector<double>& samples);

}  // namespace tdpt
