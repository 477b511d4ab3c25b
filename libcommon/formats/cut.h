// Cut files (.cut): the minimum cuts of a flow network with the geometry of its patches.
// Written by mincut; read by lightgrid and by ffgraph --refine. Self-contained with the scene.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/base/provenance.h"
#include "libcommon/math/vec.h"

namespace tdpt {

/// Patches: bounded pieces of surface with one facing side. A patch is a set of (triangle, side)
/// restricted to one cell of a grid. Level l has cells of side base_cell / 4^l; patches of several
/// levels coexist, finer ones where a coarse one straddled the opening.
struct PatchGrid {
  Vec3d origin{};        ///< metres
  double base_cell = 1;  ///< metres
};

struct Patch {
  uint32_t node;                  ///< node of the flow network
  int level = 0;                  ///< of the cell
  std::array<int32_t, 3> cell{};  ///< floor((p - origin) / (base_cell / 4^level))
  double samples = 0;             ///< etendue samples that started here (proportional to area)
  Vec3d centre{};                 ///< metres, mean of the samples
  Vec3d normal{};                 ///< unit, mean facing normal
  /// 2*triangle + side; side 0: the patch faces the triangle's front, 1: its back.
  std::vector<uint32_t> faces;
  /// Not below 0: directions of the sky, bin `sky` of sky_bins.h, and of what is above only `node`
  /// and `samples` count: there are no faces.
  int32_t sky = -1;
  bool is_sky() const { return sky >= 0; }
};

enum class Side : uint8_t { source = 0, sink = 1 };

struct CutArc {
  uint32_t from, to;  ///< indices into patches: a pivot pair, `from` in the lower region
  double capacity;    ///< in units of etendue samples
};

/// One opening of those that the light passes one behind the other.
struct Bottleneck {
  double flow = 0;         ///< value of the cut, terminals included [etendue samples]
  double conductance = 0;  ///< patch-to-patch part / smaller side's total; a bottleneck is small
};

inline constexpr uint32_t kMostCuts = 64;  ///< of one file

struct CutFile {
  std::string scene_hash;
  std::string camera;  ///< viewpoint.h; empty: unknown
  PatchGrid grid;
  std::vector<Patch> patches;
  /// Of each patch: 0 holds the light, cuts.size() the camera. Cut c parts regions 0..c from those
  /// above c.
  std::vector<uint32_t> region;
  std::vector<Bottleneck> cuts;  ///< in the light's order, 1 to kMostCuts
  std::vector<CutArc> arcs;      ///< patch-to-patch arcs from a region to a higher one
  bool bottleneck = false;       ///< false: the network has none; then there is one cut
  std::string reason;            ///< a plain sentence, why not, when !bottleneck
  Provenance provenance;
  std::string hash;  ///< content hash of the file read

  /// On which side of cut `c` a region lies.
  static Side side(uint32_t region, size_t c) { return region <= c ? Side::source : Side::sink; }
  /// Whether an arc crosses cut `c`.
  bool crosses(const CutArc& arc, size_t c) const {
    return region[arc.from] <= c && region[arc.to] > c;
  }
};

CutFile read_cut(const std::string& path);
std::string cut_text(const CutFile& file);

}  // namespace tdpt
