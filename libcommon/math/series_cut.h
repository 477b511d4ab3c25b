// Bottlenecks one behind the other: minimum cuts of a network of patches.
//
// The minimum cut finds the narrowest of several openings in series. Where the potential of a
// network of resistors (potential_sweep.h) shows drops, there is a candidate for each. Every
// candidate is drawn and judged by itself (cut_facts.h): one that is refused hides no other.
#pragma once
#include <functional>
#include <string>

#include "libcommon/math/cut_facts.h"

namespace tdpt {

struct SeriesCut {
  struct Cut {
    int64_t flow;    ///< its value, terminals included [units of the network]
    CutFacts facts;  ///< of the whole network, parted here
  };
  /// In the light's order; at least one. Cut c parts the regions 0..c from those above c.
  std::vector<Cut> cuts;
  std::vector<uint32_t> region;  ///< of each node, 0 at the source, cuts.size() at the sink
  bool bottleneck = false;       ///< whether the cuts are bottlenecks; if not there is one cut
  std::string reason;            ///< a plain sentence, why not, when !bottleneck
  /// Candidates that are no bottleneck, or one too many.
  struct Refused {
    CutFacts facts;
    std::string why;  ///< a plain sentence
  };
  std::vector<Refused> refused;

  size_t drops = 0;    ///< of the potential, looked at
  size_t passed = 0;   ///< of more, not looked at: the widest
  size_t closets = 0;  ///< of those looked at: no current passes, so nothing was cut
};

/// Solves one maximum-flow problem; a caller may check the answer on its way.
using FlowSolver = std::function<MaxFlow(const FlowNetwork&)>;

/// At most `most` cuts, those that promise most: the minimum cut of the network as it is and one at
/// each drop of the potential, as far as they are bottlenecks and not the same. At a drop,
/// terminals draw patches by how far their potential lies from it.
SeriesCut series_cut(const PatchNetwork& problem, size_t most, const CutLimits& limits,
                     const FlowSolver& solve = max_flow);

}  // namespace tdpt
