// Judges a partition of a network of patches: whether the border is an opening through which light
// must pass on its way to the camera, and if not, why.
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/flow/max_flow.h"

namespace tdpt {

/// The numbers that decide whether a cut is a bottleneck.
struct CutLimits {
  /// Each side of a bottleneck must have at least this share of the surface, of the light that
  /// surfaces exchange, or of the nodes' weight.
  double least_area = 0.03;
  /// Largest conductance of a bottleneck: capacity across the cut / capacity of all arcs from
  /// patches of the smaller side to other patches.
  double largest_conductance = 0.12;
  /// Smallest share of the camera's light that crosses a bottleneck.
  double least_carried = 0.01;
  /// Shares of what crosses, straight from lamps, and of what lamps emit, straight across, from
  /// which sampling the lamp finds the opening as well as a portal would.
  double straight = 0.25, seen = 0.1;

  /// Smallest difference of log(importance / brightness) of two rooms [potential_sweep.h].
  double least_drop = 0.7;
};

/// A network whose nodes, apart from the two terminals, are patches of surface or of the sky.
struct PatchNetwork {
  FlowNetwork network;
  std::vector<double> samples;  ///< n_i of each node: its area [samples of etendue]; terminals: 0
  double scale = 1;             ///< capacity of one sample
  /// Per node: light walks that begin on it, hits of light walks, hits of camera walks; empty:
  /// unknown.
  std::vector<double> begun{}, lit{}, viewed{};
  /// Per node: what else makes a side of a cut a room, however small beside a landscape, in any
  /// unit; empty: nothing.
  std::vector<double> weight{};

  /// Per node: whether it is a part of the sky; empty: there is no sky.
  std::vector<uint8_t> sky{};

  /// Per node: light that leaves it and light that matters to the camera, so that c_ij b_i v_j /
  /// scale is the share of the camera's light that goes from i to j [PatchLight]; empty: unknown.
  std::vector<double> brightness{}, importance{};

  double weight_of(uint32_t v) const { return weight.empty() ? 0 : weight[v]; }
  bool is_sky(uint32_t v) const { return !sky.empty() && sky[v]; }
  bool terminal(uint32_t v) const { return v == network.source || v == network.sink; }
};

/// How large a set of nodes is, by each of three measures.
struct SetSize {
  double area = 0;    ///< [samples]
  double volume = 0;  ///< sum c_ij over arcs from its patches to others
  double weight = 0;  ///< PatchNetwork::weight

  SetSize& operator+=(const SetSize& b) {
    area += b.area, volume += b.volume, weight += b.weight;
    return *this;
  }
  friend SetSize operator-(const SetSize& a, const SetSize& b) {
    return {a.area - b.area, a.volume - b.volume, a.weight - b.weight};
  }
  /// Its shares of `all`; 0 of nothing.
  SetSize share_of(const SetSize& all) const {
    const auto share = [](double part, double whole) { return whole > 0 ? part / whole : 0; };
    return {share(area, all.area), share(volume, all.volume), share(weight, all.weight)};
  }
  double largest() const { return std::max({area, volume, weight}); }
};

/// Figures of a cut with sides S (0, the light's) and T (1, the camera's); c_ij is the capacity
/// between patches.
struct CutFacts {
  std::array<SetSize, 2> side{};  ///< shares of the whole
  double crossing = 0;            ///< sum of c_ij from S to T
  double conductance = 1;         ///< crossing / smaller volume of a side
  /// Share of the camera's light that crosses from S to T, and from T to S; unknown without b_i and
  /// v_j. Light that crosses several times counts each time.
  std::optional<double> carried, carried_back;
  /// Light walks that cross from S to T: from patch i they do with probability sum_{j in T} c_ij /
  /// n_i. Share of them that come straight from a lamp, without a surface in between; and share of
  /// all that lamps on S emit that does so. Unknown without walks.
  std::optional<double> straight, seen;

  /// Compared with least_area: a wide ground has much area and exchanges little light.
  double smaller_side() const { return std::min(side[0].largest(), side[1].largest()); }
};

/// `source_side`: per node.
CutFacts facts_of(const PatchNetwork& problem, const std::vector<uint8_t>& source_side);

/// The reason where the flow to the camera is 0.
inline constexpr const char* kNoLightFound =
    "no light was found to reach the camera's room: is its door shut? A very small opening may "
    "have been missed";

/// A plain sentence why the cut is no bottleneck; empty if it is one.
std::string why_refused(const CutFacts& facts, const CutLimits& limits);

/// Score of a bottleneck: larger if more of the camera's light crosses it, and if it is narrower.
double promise_of(const CutFacts& facts);

}  // namespace tdpt
