// Cut files (.cut): the minimum cuts of a flow network with the geometry of its patches. Written by
// mincut; read by lightgrid and by ffgraph --refine. Self-contained together with the scene.
#pragma once
#include <algorithm>
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

/// What a patch means for the light of the pictures: of all light of camera k's picture n_ij/2 b_i
/// v_j^k goes from patch i to patch j without a surface in between, n_ij their etendue [samples].
struct PatchLight {
  double brightness = 0;  ///< b: light that leaves it, per sample
  std::vector<double>
      importance{};  ///< v^k: share of what reaches it that camera k sees in the end
};

/// What networks and cuts have in common: the patches of a scene, and where they come from.
struct PatchFile {
  std::string scene_hash;
  std::vector<std::string> cameras;  ///< viewpoint.h; empty: one, unknown
  PatchGrid grid;
  std::vector<Patch> patches;
  std::vector<PatchLight> light;  ///< per patch; empty: unknown
  Provenance provenance;
  std::string hash;  ///< content hash of the file read

  size_t number_of_cameras() const { return std::max<size_t>(1, cameras.size()); }
};

enum class Side : uint8_t { source = 0, sink = 1 };

struct CutArc {
  uint32_t from, to;  ///< indices into patches of a pivot pair, `from` on the light's side
  double capacity;    ///< in units of etendue samples
};

/// One of several openings.
struct Bottleneck {
  double flow = 0;         ///< value of the cut, terminals included [etendue samples]
  double conductance = 0;  ///< patch-to-patch part / smaller side's total; small for a bottleneck
  uint32_t camera = 0;     ///< index of the one whose light it lets through
};

inline constexpr uint32_t kMostCuts = 64;     ///< of one file
inline constexpr uint32_t kMostCameras = 64;  ///< of one file

struct CutFile : PatchFile {
  /// Per patch: bit c is set on the camera's side of cut c.
  std::vector<uint64_t> sides;
  std::vector<Bottleneck> cuts;  ///< of each camera from the light to it, 1 to kMostCuts
  std::vector<CutArc> arcs;      ///< patch-to-patch arcs that cross some cut
  bool bottleneck = false;       ///< false: the network has none; then there is one cut
  std::string reason;            ///< a plain sentence why not, if !bottleneck

  /// The name of camera `k`, for messages; empty where there is only one.
  std::string name_if_several(size_t k) const;
  static Side side(uint64_t sides, size_t c) { return sides >> c & 1 ? Side::sink : Side::source; }
  Side side_of(size_t patch, size_t c) const { return side(sides[patch], c); }
  /// Whether an arc crosses cut `c`, or any.
  bool crosses(const CutArc& arc, size_t c) const { return crossed(arc) >> c & 1; }
  uint64_t crossed(const CutArc& arc) const { return sides[arc.to] & ~sides[arc.from]; }
};

CutFile read_cut(const std::string& path);
std::string cut_text(const CutFile& file);

}  // namespace tdpt
