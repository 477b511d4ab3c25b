// What lines of light are drawn from: the pivot pairs of a cut, the surface of their patches, and
// which patch holds a place on a surface. Flat tables, in the layout of shaders/shared/: alias
// tables (Vose) over pairs by capacity and over pieces of patches by area, sorted cells by face.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/cut.h"
#include "libcommon/scene/scene.h"
#include "shaders/shared/light_layout.h"

namespace tdpt {

struct LineTables {
  struct PairsOfCut {
    uint32_t first = 0, count = 0;  ///< of `pivot_arcs`
  };
  std::vector<PairsOfCut> cuts;
  std::vector<shader::PivotArc> pivot_arcs;
  std::vector<shader::PatchPieces> patches;  ///< as in the cut file; no pieces where no arc asks
  std::vector<shader::Piece> pieces;
  std::vector<uint32_t> first_cell;            ///< of each face, and one more; into `patch_cells`
  std::vector<shader::PatchCell> patch_cells;  ///< of each face in order
  std::vector<shader::FaceNormal> face_normals;

  shader::vec3 cell_corner{};  ///< canonical
  float cells_per_unit = 1;
  uint32_t levels = 0;
  uint32_t first_sky_face = UINT32_MAX;  ///< this and all behind are the sky's, see sky_dome.h
};

/// `scene` has a dome where the cut has a sky. Throws InputError when the cut names triangles the
/// scene does not have; `cut_name` names the cut file in the message.
LineTables make_line_tables(const Scene& scene, const CutFile& cut, const std::string& cut_name);

}  // namespace tdpt
