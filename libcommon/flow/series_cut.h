// Several bottlenecks in series: minimum cuts of a network of patches.
//
// One minimum cut finds only the narrowest of several openings in series. So each drop of the
// potential of a resistor network (potential_sweep.h) gives a candidate. Each candidate is cut and
// judged on its own (cut_facts.h): rejecting one does not hide another.
#pragma once
#include <functional>
#include <string>

#include "libcommon/flow/cut_facts.h"

namespace tdpt {

struct SeriesCut {
  struct Cut {
    int64_t flow;    ///< capacity of the cut, terminals included [units of the network]
    CutFacts facts;  ///< of the whole network, partitioned here
  };
  /// From the light to the camera; at least one. Cut c separates regions 0..c from those above c.
  std::vector<Cut> cuts;
  std::vector<uint32_t> region;  ///< per node, 0 at the source, cuts.size() at the sink
  bool bottleneck = false;       ///< whether the cuts are bottlenecks; if not, there is one cut
  std::string reason;            ///< a plain sentence why not, if !bottleneck
  /// Candidates that are no bottlenecks, or that exceed the number allowed.
  struct Refused {
    CutFacts facts;
    std::string why;  ///< a plain sentence
  };
  std::vector<Refused> refused;

  size_t drops = 0;   ///< drops of the potential that were examined
  size_t passed = 0;  ///< further drops, not examined: the widest openings
};

/// Called with each maximum flow and the network that it solves; may verify it. Several threads.
using FlowCheck = std::function<void(const FlowNetwork&, const MaxFlow&)>;

/// At most `most` cuts, those with the highest promise_of(). Candidates are the minimum cut of the
/// network as it is and one cut at each drop of the potential; those that are no bottlenecks, or
/// duplicates, are dropped. At a drop, the data terms of patches grow with the distance of their
/// potential from it.
SeriesCut series_cut(const PatchNetwork& problem, size_t most, const CutLimits& limits,
                     const FlowCheck& check = {});

/// series_cut() in the part of the network that the light's walks or this camera's hit: what a
/// network of this camera alone would hold, so that rooms of other cameras neither cost time nor
/// count as a side of a cut. Other nodes then get the region to which most of their capacity leads,
/// or that of the light. `whole` must know the hits.
SeriesCut camera_cut(const PatchNetwork& whole, size_t most, const CutLimits& limits,
                     const FlowCheck& check = {});

}  // namespace tdpt
