// Builds the flow network of a scene: patches are nodes, etendue is capacity, and the terminals are
// connected by unary (data) terms as in graph-cut segmentation. It replaces the paper's network
// [section 4.1]. Its minimum cut separates the surfaces that the light reaches from those that the
// camera reaches where least light is exchanged: at the openings between them.
//
// n_i       samples of patch i, in proportion to its area
// n_ij      etendue of a pair (etendue.h): arcs of capacity n_ij / 2 either way
// H_E, H_W  hits of light walks and of camera walks: capacity of source -> i is n_i grade(H_E), of
//           i -> sink n_i grade(H_W), see terminal_grades(). Each camera has its own sink and H_W
//
// A camera whose room no light was found to reach has no arcs to its sink: a patch may lie on both
// sides of a closed door, and its etendue would pass.
//
// Light from infinity has patches, too, one per bin of directions (sky_bins.h). The rays that leave
// the scene connect them to surfaces, and their brightness connects them to the source. Walks that
// begin there do not count in the grades of surfaces: their hits are spread over a wide ground, and
// compared with that any room near a window is bright.
#pragma once
#include "libcommon/formats/dimacs.h"
#include "tools/ffgraph/etendue.h"
#include "tools/ffgraph/walks.h"

namespace tdpt {

/// Patches are split down to this many levels below those of the fine region: cells of 1/64 of
/// their side.
inline constexpr int kDeepestSplit = 3;

inline constexpr double kCapacityScale = 4096;

struct LightFlow {
  PatchMap patches;
  Etendue etendue;
  std::vector<uint8_t> lit;  ///< of each camera: whether light was found to reach its room
  /// Node 0: source, 1: the first camera's sink, k + 2: patch k; then the other cameras' sinks. It
  /// names neither cameras nor provenance.
  DimacsFile file;
};

/// The walks from the light and from the cameras.
struct BothWalks {
  LightWalks light;
  std::vector<Walks> cameras;
  std::vector<double> sky_grade;  ///< data term of each bin: share of its etendue that is its
                                  ///< capacity from the source
};

/// Builds the patches that a walk touched, their etendue and the network. `patches` says which
/// cells are split; it contains no patch yet.
LightFlow light_flow(PatchMap patches, const BothWalks& walks, const Tracer& tracer, uint64_t seed,
                     uint32_t rays);

/// Patches that send less than `share` of their etendue to one side of a cut: they straddle the
/// opening. `side`: per patch.
std::vector<uint8_t> straddling(const Etendue& etendue, const std::vector<Side>& side,
                                double share);

/// What the light of the pictures needs to know of each patch [camera_light.cpp]; only `emitted`
/// counts for a bin of the sky.
struct LightTerms {
  std::vector<double> emitted;            ///< E_i
  std::vector<double> direct;             ///< D_i, in the same unit
  std::vector<double> albedo;             ///< r_i
  std::vector<std::vector<double>> seen;  ///< of each camera W_i
};

/// b and v of each patch, v 0 for cameras that none of the light reaches; empty if it reaches none.
std::vector<PatchLight> camera_light(const PatchMap& patches, const Etendue& etendue,
                                     const LightTerms& terms);

/// Albedo of each material of a scene, luminance: that of its factors and of the mean of its
/// texture; what it transmits is no part of it.
std::vector<double> albedos_of(const Scene& scene);

}  // namespace tdpt
