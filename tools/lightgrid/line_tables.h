// Tables for sampling lines of light: the pivot pairs of a cut, the surface of their patches, and
// the patch at a given surface point. Flat, in the layout of shaders/shared/: alias tables (Vose)
// over pairs by capacity and over pieces of patches by area, and cells sorted by face.
#pragma once
#include <string>
#include <vector>

#include "libcommon/formats/cut.h"
#include "libcommon/scene/scene.h"
#include "shaders/shared/light_layout.h"

namespace tdpt {

struct LineTables {
  struct PairsOfCut {
    uint32_t first = 0, count = 0;  ///< range in `pivot_arcs`
    uint32_t camera = 0;            ///< whose light crosses it
  };
  std::vector<PairsOfCut> cuts;
  std::vector<shader::PivotArc> pivot_arcs;
  std::vector<shader::PatchPieces> patches;  ///< as in the cut file; no pieces if no arc uses it
  std::vector<shader::Piece> pieces;
  std::vector<uint32_t> first_cell;            ///< per face, plus one; indices into `patch_cells`
  std::vector<shader::PatchCell> patch_cells;  ///< grouped by face
  std::vector<shader::FaceNormal> face_normals;
  std::vector<uint32_t> region_sides;   ///< two words per region
  std::vector<uint32_t> patch_of_cell;  ///< per entry of patch_cells
  std::vector<PatchLight> light;        ///< per patch; empty: unknown

  shader::vec3 cell_corner{};  ///< canonical
  float cells_per_unit = 1;
  uint32_t levels = 0;
  uint32_t first_sky_face = UINT32_MAX;  ///< faces from here on belong to the sky
};

/// `scene` must have a dome if the cut has a sky. Throws InputError if the cut refers to triangles
/// that the scene does not have; `cut_name` names the cut file in the message.
LineTables make_line_tables(const Scene& scene, const CutFile& cut, const std::string& cut_name);

// The sky as surfaces: a distant dome of triangles around a scene, one per bin of directions
// (sky_bins.h). Lines of light from the sky begin on it, and lines that leave the scene end on it,
// as on any patch.

/// Whether a cut has sky directions among its nodes.
bool has_sky(const CutFile& cut);

/// Adds the dome after all triangles, facing inwards, and sets `scene.dome`.
void add_sky_dome(Scene& scene);

}  // namespace tdpt
