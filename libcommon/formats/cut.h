// Cut files (.cut): the minimum cuts of a flow network with the geometry of its patches. Written by
// mincut; read by lightgrid and by ffgraph --refine. Self-contained together with the scene.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/base/provenance.h"
#include "libcommon/math/vec.h"

namespace tdpt {

/// Patches are bounded pieces of surface with one facing side: a set of (triangle, side) restricted
/// to one cell of a grid. Level l has cells of side base_cell / 4^l; levels are mixed, finer where
/// a coarse patch straddled the opening.
struct PatchGrid {
  Vec3d origin{};        ///< metres
  double base_cell = 1;  ///< metres
};

struct Patch {
  uint32_t node;                  ///< node of the flow network
  int level = 0;                  ///< of the cell
  std::array<int32_t, 3> cell{};  ///< floor((p - origin) / (base_cell / 4^level))
  double samples = 0;  ///< number of etendue samples that started here (proportional to area)
  Vec3d centre{};      ///< metres, mean of the samples
  Vec3d normal{};      ///< unit, mean facing normal
  /// 2*triangle + side; side 0: the patch faces the triangle's front, 1: its back.
  std::vector<uint32_t> faces;
  /// If not negative: the patch is bin `sky` of the sky's directions (sky_bins.h); then only `node`
  /// and `samples` are used, and there are no faces.
  int32_t sky = -1;
  bool is_sky() const { return sky >= 0; }
};

/// What a patch means for the light of the picture: of all of it n_ij/2 b_i v_j goes from patch i
/// to patch j without a surface in between, n_ij their etendue [samples].
struct PatchLight {
  double brightness = 0;  ///< b: light that leaves it, per sample
  double importance = 0;  ///< v: share of what reaches it that the camera sees in the end
};

enum class Side : uint8_t { source = 0, sink = 1 };

struct CutArc {
  uint32_t from, to;  ///< indices into patches of a pivot pair, `from` in the lower region
  double capacity;    ///< in units of etendue samples
};

/// One of several openings in series.
struct Bottleneck {
  double flow = 0;         ///< value of the cut, terminals included [etendue samples]
  double conductance = 0;  ///< patch-to-patch part / smaller side's total; small for a bottleneck
};

inline constexpr uint32_t kMostCuts = 64;  ///< of one file

struct CutFile {
  std::string scene_hash;
  std::string camera;  ///< viewpoint.h; empty: unknown
  PatchGrid grid;
  std::vector<Patch> patches;
  std::vector<PatchLight> light;  ///< per patch; empty: unknown
  /// Per patch: 0 contains the light, cuts.size() the camera. Cut c separates regions 0..c from
  /// those above c.
  std::vector<uint32_t> region;
  std::vector<Bottleneck> cuts;  ///< from the light to the camera, 1 to kMostCuts
  std::vector<CutArc> arcs;      ///< patch-to-patch arcs from a region to a higher one
  bool bottleneck = false;       ///< false: the network has none; then there is one cut
  std::string reason;            ///< a plain sentence why not, if !bottleneck
  Provenance provenance;
  std::string hash;  ///< content hash of the file read

  /// The side of cut `c` that a region lies on.
  static Side side(uint32_t region, size_t c) { return region <= c ? Side::source : Side::sink; }
  /// Whether an arc crosses cut `c`.
  bool crosses(const CutArc& arc, size_t c) const {
    return region[arc.from] <= c && region[arc.to] > c;
  }
};

CutFile read_cut(const std::string& path);
std::string cut_text(const CutFile& file);

}  // namespace tdpt
