// The flow network of a scene, in the place of the paper's [section 4.1]: patches as nodes, etendue
// as capacity, terminals by data terms as in graph-cut segmentation.
//
// n_i       samples of patch i, in proportion to its area
// n_ij      etendue of a pair (etendue.h): arcs of capacity n_ij / 2 either way
// H_E, H_W  hits of the walks from the light and from the camera (east and west of the aperture, so
//           to speak): source -> i n_i grade(H_E), i -> sink n_i grade(H_W), see terminal_grades()
//
// What shines from infinity is patches, too, one for each bin of directions (sky_bins.h), joined to
// those of surfaces by the rays that leave the scene, and to the source by how bright they are. The
// grades of surfaces leave out what walks from there hit: it is spread over a wide ground, against
// which any room near a window is bright.
//
// Its minimum cut parts the surfaces that the light reaches from those that the camera does where
// least light is exchanged: at the openings between them.
#pragma once
#include "libcommon/formats/dimacs.h"
#include "tools/ffgraph/etendue.h"
#include "tools/ffgraph/walks.h"

namespace tdpt {

/// Patches are split down to this many levels below those of the fine region: cells of 1/64 of
/// theirs.
inline constexpr int kDeepestSplit = 3;

inline constexpr double kCapacityScale = 4096;

struct LightFlow {
  PatchMap patches;
  std::vector<Patch> geometry;  ///< of each patch
  Etendue etendue;
  std::vector<double> hits_light, hits_camera;  ///< H_E, H_W of each patch
  std::vector<double> begun;                    ///< walks of the light that begin on each patch
  std::vector<double> lit_by_sky;               ///< of H_E, those of walks from the sky
  FlowNetwork network;                          ///< node 0: source, 1: sink, k + 2: patch k
};

/// What the walks found, from both ends.
struct BothWalks {
  Walks light, camera;
  size_t of_light = 0;            ///< walks that the light's are
  std::vector<WalkHit> starts;    ///< of the light's, those that begin on a surface
  SkyStarts from_sky;             ///< empty: there is no sky
  std::vector<double> sky_grade;  ///< of each bin: how much of its etendue the source feeds
};

/// Patches that a walk touched, their etendue and the network. `patches` says which cells are split
/// and holds no patch yet.
LightFlow light_flow(PatchMap patches, const BothWalks& walks, const Tracer& tracer, uint64_t seed,
                     uint32_t rays);

/// Patches that send less than `share` of their etendue to one side of a cut: they straddle the
/// opening. `side` of each patch.
std::vector<uint8_t> straddling(const Etendue& etendue, const std::vector<Side>& side,
                                double share);

/// Network and geometry as a file, without provenance.
DimacsFile dimacs_file(const LightFlow& flow);

}  // namespace tdpt
