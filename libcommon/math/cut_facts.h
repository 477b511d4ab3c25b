// Judges a partition of a network of patches: whether the border is an opening through which light
// must pass on its way to the camera, and if not, why.
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/math/max_flow.h"

namespace tdpt {

struct CutLimits {
  /// Each side of a bottleneck must have at least this share of the surface or of the light that
  /// surfaces exchange.
  double least_area = 0.03;
  /// Largest conductance of a bottleneck: capacity across the cut / capacity of all arcs from
  /// patches of the smaller side to other patches.
  double largest_conductance = 0.12;
};

/// A network whose nodes, apart from the two terminals, are patches of surface or of the sky.
struct PatchNetwork {
  FlowNetwork network;
  std::vector<double> samples;  ///< n_i of each node: its area [samples of etendue]; terminals: 0
  double scale = 1;             ///< capacity of one sample
  /// Per node: light walks that begin on it, hits of light walks, hits of camera walks; empty:
  /// unknown.
  std::vector<double> begun{}, lit{}, viewed{};

  /// Per node: whether it is a part of the sky; empty: there is no sky.
  std::vector<uint8_t> sky{};

  /// Per node: light that leaves it and light that matters to the camera, so that c_ij b_i v_j /
  /// scale is the share of the camera's light that goes from i to j [PatchLight]; empty: unknown.
  std::vector<double> brightness{}, importance{};

  bool is_sky(uint32_t v) const { return !sky.empty() && sky[v]; }
  bool terminal(uint32_t v) const { return v == network.source || v == network.sink; }
};

/// Figures of a cut with sides S (0, the light's) and T (1, the camera's); c_ij is the capacity
/// between patches.
struct CutFacts {
  std::array<double, 2> area{};    ///< share of the surface
  std::array<double, 2> volume{};  ///< share of sum c_ij over arcs from the side's patches
  double crossing = 0;             ///< sum of c_ij from S to T
  double conductance = 1;          ///< crossing / smaller sum c_ij of a side
  /// Walks that cross from S to T; from patch i they do with probability p_i = sum_{j in T} c_ij /
  /// n_i:
  ///   straight sum b_i p_i, scattered sum h_i p_i,  b_i begun on patch i, h_i hits of it.
  /// Unknown without b_i, h_i and the hits w_i of camera walks.
  std::optional<double> across;  ///< share of the light reaching T that crosses the cut, rather
                                 ///< than coming from lamps on T
  /// Walks that come back / walks that cross. `back`: light walks from T / those from S;
  /// `camera_back`: sum of w_i p_i from S / that from T. Near 1 there is no net flow across. `back`
  /// is unknown for light from the sky, about which it says nothing; both are unknown if fewer than
  /// ten walks cross.
  std::optional<double> back, camera_back;
  std::optional<double> straight;  ///< share of what crosses that comes straight from a lamp,
                                   ///< without a surface in between
  std::optional<double> seen;      ///< share of what lamps on S emit that crosses directly
  /// Share of the camera's light that crosses from S to T, and from T to S; unknown without b_i and
  /// v_j. Light that crosses several times counts each time.
  std::optional<double> carried, carried_back;
  /// Share of the source's capacity to the sky that goes to parts of it on T. The sky is one light.
  double sky_beyond = 0;
  /// Share of the crossing that leaves parts of the sky, which T sees through the opening.
  double sky_across = 0;
  /// Share of the camera walks' hits; only for a network with a sky, because a landscape has much
  /// more area than the room with the camera.
  std::array<double, 2> viewed{};

  /// Compared with least_area: a wide ground has much area and exchanges little light, and so does
  /// a side open to the sky.
  double side(size_t s) const { return std::max({area[s], volume[s], viewed[s]}); }
  double smaller_side() const { return std::min(side(0), side(1)); }
};

/// `source_side`: per node.
CutFacts facts_of(const PatchNetwork& problem, const std::vector<uint8_t>& source_side);

/// Whether a cut separates two rooms at an opening, even a wide one: in an open room any border is
/// wider.
bool still_opening(const CutFacts& facts, const CutLimits& limits);

/// Whether lamps on the light's side shine through the opening directly: then light sampling finds
/// it as well as a portal does.
bool lamp_in_its_opening(const CutFacts& facts, const CutLimits& limits);

/// A plain sentence why the cut is no bottleneck; empty if it is one.
std::string why_refused(const CutFacts& facts, const CutLimits& limits);

/// Describes the cut, without a full stop.
std::string words_for(const CutFacts& facts);

/// Score of a bottleneck from all that is known: larger if more of the light comes across, less of
/// it straight from lamps, and if it is narrower.
double promise_of(const CutFacts& facts);

}  // namespace tdpt
