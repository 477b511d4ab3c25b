// Planar portals fitted to the lines of a light grid (section 4.3).
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/formats/portal.h"

namespace tdpt {

struct PortalFitOptions {
  std::string method = "tube";  ///< or "paper": portal_by_paper()
  int64_t max_portals = 8;      ///< of each camera
  double threshold = 0.02;      ///< smallest share of a camera's light that makes a portal
  /// Least share of its outline that is an edge: of most openings it is 0.4 to 1, of planes across
  /// a room 0 to 0.2.
  double least_edge = 0.3;
};

/// Figures of merit of each portal: `area` [m2], `flux_share` (share of the camera's light that
/// crosses it, or of the lines of its cut if that is unknown; of several cameras the largest),
/// `support` (share of the lines
/// through it that join the two sides; omitted if unknown), `direction_x/y/z` (mean direction of
/// its lines), `edge` (edge_share(), omitted if unknown), `direction_angle` [deg] (between it and
/// the normal), `concentration` (length of the mean of the unit directions), `pca_main_angle` and
/// `pca_minor_angle` [deg] (between the normal and the axes of the paper's rule, for information).
struct FitResult {
  /// A rejected candidate.
  struct Refusal {
    std::string why;                             ///< a plain sentence with its figure and the limit
    std::vector<std::vector<Vec3d>> polygons{};  ///< its outline [metres], or those of several
  };
  std::vector<Portal> portals;
  /// By portal: the lines that its flux_share counts, as indices into grid.lines, ascending.
  std::vector<std::vector<uint32_t>> lines;
  double explained = 0;  ///< share of all lines that cross some portal
  std::vector<Refusal> refused;
};

FitResult fit_portals(const LightGrid& grid, const PortalFitOptions& options);

/// Adds figures of portal(5) to each portal: `cut` (the one that has the largest share of its lines
/// cross the portal), `tightness` (share of the lines through the portal that pass from one side to
/// the other: positions uniform, directions cosine-distributed), and `conductance` if the grid
/// knows its cuts (of the cut, as far as its lines cross its portals), and `sky` (share of the
/// portal's lines that come from outside the grid and pass no other portal before it; left out if
/// the grid names no scene or does not tell air from walls, as tables).
void appraise(const LightGrid& grid, std::vector<Portal>& portals);

// The paper's rule (section 4.3), for comparison: the normal is the main principal axis (PCA) of
// the full voxels; those that the plane through the fullest of them intersects are projected onto
// it, and the outline is their hull. Ours are the threshold of a full voxel, half the largest
// count, since the paper gives none, and the side that the front faces.

/// Principal axes of the centres of the voxels with at least `share` of the fullest one's count.
struct VoxelAxes {
  std::vector<Vec3d> centres;     ///< metres
  Vec3d mean{}, main{}, minor{};  ///< unit axes; zero when there are no voxels
};
VoxelAxes axes_of_full_voxels(const LightGrid& grid, double share);

/// One portal, whose front is turned the way the light goes. None if the centres of the voxels make
/// no polygon.
FitResult portal_by_paper(const LightGrid& grid);

}  // namespace tdpt
