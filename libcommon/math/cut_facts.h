// What it means to part a network of patches in two: whether the border is an opening that the
// light has to pass on its way to the camera, and if not, why.
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/math/max_flow.h"

namespace tdpt {

struct CutLimits {
  /// Share that either side of a bottleneck must have, of the surface or of the light that
  /// surfaces exchange.
  double least_area = 0.03;
  /// Conductance: capacity across the cut / capacity of all arcs that leave patches of the smaller
  /// side for other patches. A bottleneck's is at most this.
  double largest_conductance = 0.12;
};

/// A network whose nodes but two are patches of surface, or of the sky.
struct PatchNetwork {
  FlowNetwork network;
  std::vector<double> samples;  ///< n_i of each node: its area [samples of etendue]; terminals: 0
  double scale = 1;             ///< capacity of one sample
  /// Of each node: walks of the light that begin on it, hits of such walks, and of the camera's;
  /// empty: unknown.
  std::vector<double> begun{}, lit{}, viewed{};

  /// Of each node: whether it is a part of the sky; empty: there is none.
  std::vector<uint8_t> sky{};

  bool is_sky(uint32_t v) const { return !sky.empty() && sky[v]; }
  bool terminal(uint32_t v) const { return v == network.source || v == network.sink; }
};

/// Of a cut with sides S (0, the light's) and T (1, the camera's); c_ij capacity between patches.
struct CutFacts {
  std::array<double, 2> area{};    ///< share of the surface
  std::array<double, 2> volume{};  ///< share of sum c_ij that leaves the side's patches
  double crossing = 0;             ///< sum of c_ij from S to T
  double conductance = 1;          ///< crossing / smaller sum c_ij of a side
  /// Walks that cross from S to T, from patch i by the chance p_i = sum_{j in T} c_ij / n_i:
  ///   straight sum b_i p_i, scattered sum h_i p_i,  b_i begun on patch i, h_i hits of it.
  /// Unknown without b_i, h_i and the hits w_i of the camera's walks.
  std::optional<double> across;  ///< of the light that comes to T: what crosses; not T's lamps'
  /// Walks that come back over those that cross: the light's from T over those from S, and the
  /// camera's, the sum of w_i p_i, from S over those from T. Near 1 nothing goes across on balance.
  /// Of light from the sky `back` tells nothing and is not known, nor is either of walks of which
  /// fewer than ten cross.
  std::optional<double> back, camera_back;
  std::optional<double> straight;  ///< of what crosses: what comes from a lamp without a surface
  std::optional<double> seen;      ///< of what lamps on S send: what crosses at once
  /// Of what the source feeds to the sky: what it feeds to parts of it on T. The sky is one light.
  double sky_beyond = 0;
  /// Of the crossing: what leaves parts of the sky, so that T sees them through the opening.
  double sky_across = 0;
  /// Share of the hits of the camera's walks; of a network with a sky only: a landscape has much
  /// more area than the room that the camera stands in.
  std::array<double, 2> viewed{};

  /// What stands against least_area: a wide ground has much area and exchanges little light, a side
  /// open to the sky the same.
  double side(size_t s) const { return std::max({area[s], volume[s], viewed[s]}); }
  double smaller_side() const { return std::min(side(0), side(1)); }
};

/// `source_side`: of each node.
CutFacts facts_of(const PatchNetwork& problem, const std::vector<uint8_t>& source_side);

/// Whether a cut parts two rooms at an opening, if a wide one: in an open room any border is wider.
bool still_opening(const CutFacts& facts, const CutLimits& limits);

/// Whether the lamps on the light's side shine through the opening themselves: sampling them finds
/// it as well as a portal.
bool lamp_in_its_opening(const CutFacts& facts, const CutLimits& limits);

/// A plain sentence, why the cut is no bottleneck; empty when it is.
std::string why_refused(const CutFacts& facts, const CutLimits& limits);

/// What the cut is, without a full stop.
std::string words_for(const CutFacts& facts);

/// How much a bottleneck promises, from all that is known: more where more of the light comes
/// across, less of it straight from lamps, and where it is narrower.
double promise_of(const CutFacts& facts);

}  // namespace tdpt
