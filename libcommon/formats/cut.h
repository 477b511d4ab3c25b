// Cut files (.cut): the minimum cut of a flow network with the geometry of its patches.
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
};

enum class Side : uint8_t { source = 0, sink = 1 };

struct CutArc {
  uint32_t from, to;  ///< indices into patches: source side -> sink side, a pivot pair
  double capacity;    ///< in units of etendue samples
};

struct CutFile {
  std::string scene_hash;
  PatchGrid grid;
  std::vector<Patch> patches;
  std::vector<Side> side;    ///< of each patch
  std::vector<CutArc> arcs;  ///< patch-to-patch arcs of the cut
  double flow = 0;           ///< value of the cut, terminals included [etendue samples]
  double conductance = 0;    ///< patch-to-patch part / smaller side's total; a bottleneck is small
  bool bottleneck = false;   ///< false: the network has none (then arcs may be empty)
  std::string reason;        ///< a plain sentence, why not, when !bottleneck
  Provenance provenance;
  std::string hash;  ///< content hash of the file read
};

CutFile read_cut(const std::string& path);
std::string cut_text(const CutFile& file);

}  // namespace tdpt
