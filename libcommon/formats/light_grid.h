// Light grids (.vdb): where light between pivot patches passes through the air.
// Written by lightgrid; read by portalfit. OpenVDB stays behind this header.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "libcommon/base/provenance.h"
#include "libcommon/formats/cut.h"
#include "libcommon/math/vec.h"
#include "shaders/shared/grid_walk.h"

namespace tdpt {

/// One sampled line of light between the two sides of a cut, metres, from `light` (on the source
/// side's surface) to `camera` (on the sink side's).
struct LightLine {
  Vec3d light, camera;
  uint32_t cut = 0;  ///< index of the cut in the .cut file, from the light to the camera
  /// Share of the camera's light that the line stands for; 0: unknown. All lines of a cut together
  /// have the share that crosses it.
  double share = 0;
};

/// A line in a random direction through one of the fullest voxels, up to the surfaces that it
/// hits.
struct Probe {
  LightLine line;      ///< from the light to the camera if `joins`; else in either direction
  bool joins = false;  ///< whether it connects the two sides
};

/// A sheet of solid glass, between two parallel planes: a point of one face and that of the other
/// which is opposite [metres]. Panes in one plane are one.
struct GridPane {
  Vec3d front, back;
  bool operator==(const GridPane&) const = default;
};

/// How narrow the passage through one cut is.
struct CutFigures {
  double conductance = 0;  ///< of the cut, see cut(5): 0 to 1
  double kept = 0;         ///< share of the visible segments that are not leaks: 0 to 1
  uint32_t camera = 0;     ///< index of the one whose light crosses it
  bool operator==(const CutFigures&) const = default;
};

/// Dense box of cubic voxels. Index (i,j,k) is at [i + dim[0] * (j + dim[1] * k)]; voxel (i,j,k)
/// spans origin + voxel * [i, i+1) x [j, j+1) x [k, k+1).
struct LightGrid {
  Vec3d origin{};    ///< metres
  double voxel = 1;  ///< side in metres
  std::array<int, 3> dim{};
  std::vector<float> count;      ///< segments through each voxel of air; 0 elsewhere
  std::vector<uint8_t> air;      ///< 1: free of geometry
  std::vector<Vec3f> direction;  ///< sum of unit directions towards the camera / count
  std::vector<LightLine> lines;  ///< a sample of the segments themselves
  std::vector<Probe> probes;     ///< empty: unknown
  bool bottleneck = true;
  std::string reason;            ///< why not
  double flux_share = 1;         ///< share of the drawn segments that were kept, see lightgrid(1)
  std::vector<CutFigures> cuts;  ///< per cut, from the light to the camera; empty: unknown
  /// Unit normals, either side's, of the directions in which many of the building's surfaces face,
  /// the most frequent first; at most kMostWalls; empty: unknown.
  std::vector<Vec3d> walls{};
  /// The largest first; at most kMostPanes; empty: none, or unknown.
  std::vector<GridPane> panes{};
  std::string scene_hash;
  std::vector<std::string> cameras;  ///< viewpoint.h; empty: one, unknown
  Provenance provenance;
  std::string hash;  ///< content hash of the file read

  size_t number_of_cameras() const { return std::max<size_t>(1, cameras.size()); }
  /// Index of the camera of a cut; the first, where that is unknown.
  size_t camera_of(uint32_t cut) const { return cut < cuts.size() ? cuts[cut].camera : 0; }
  size_t index(int i, int j, int k) const {
    return static_cast<size_t>(i) +
           static_cast<size_t>(dim[0]) *
               (static_cast<size_t>(j) + static_cast<size_t>(dim[1]) * static_cast<size_t>(k));
  }
};

/// Calls visit(voxel index, length inside [metres]) for each voxel that segment a-b passes, in
/// order (grid_walk.h). Parts outside the grid are skipped.
template <class Visit>
void walk_grid(const LightGrid& grid, const Vec3d& a, const Vec3d& b, Visit&& visit) {
  const Vec3d p = (a - grid.origin) / grid.voxel, d = (b - a) / grid.voxel;
  double enter = 0, leave = 1;
  for (int c = 0; c < 3; ++c) {
    const double side = grid.dim[static_cast<size_t>(c)];
    if (d[c] == 0) {
      if (!(p[c] >= 0 && p[c] < side)) return;
      continue;
    }
    const double t0 = -p[c] / d[c], t1 = (side - p[c]) / d[c];
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  if (!(enter < leave)) return;
  const double whole = (leave - enter) * length(b - a);
  auto walk =
      shader::voxel_walk(p + d * enter, p + d * leave, {grid.dim[0], grid.dim[1], grid.dim[2]});
  double t = 0;
  do {
    const double to = std::max(t, shader::leaves_voxel(walk));
    visit(grid.index(walk.at.x, walk.at.y, walk.at.z), (to - t) * whole);
    t = to;
  } while (shader::next_voxel(walk));
}

/// The largest share of a line; light that crosses a cut several times counts each time.
constexpr double kMostShare = 1e6;

constexpr size_t kMostWalls = 16;
constexpr size_t kMostPanes = 64;

/// Whether its faces are finite places apart from each other.
inline bool is_pane(const GridPane& pane) {
  const double thick = length(pane.back - pane.front);
  return is_finite(pane.front) && thick > 0 && std::isfinite(thick);
}

/// Largest number of voxels in a grid.
constexpr size_t kMostVoxels = size_t{1} << 27;
constexpr int kMostVoxelsPerSide = 2048;

/// Centre of the voxel with this index [metres].
inline Vec3d centre_of(const LightGrid& grid, size_t voxel) {
  const auto nx = static_cast<size_t>(grid.dim[0]), ny = static_cast<size_t>(grid.dim[1]);
  return grid.origin + Vec3d{static_cast<double>(voxel % nx) + 0.5,
                             static_cast<double>(voxel / nx % ny) + 0.5,
                             static_cast<double>(voxel / nx / ny) + 0.5} *
                           grid.voxel;
}

/// Reads a file made by light_grid_bytes(), in a child process, so that no input can crash this
/// one. "-": standard input. Throws InputError.
LightGrid read_light_grid(const std::string& path);
/// The same for bytes in memory, called `name`.
LightGrid read_light_grid(const std::string& bytes, const std::string& name);
/// The same in this process and on this thread alone. Given bytes that it did not write, OpenVDB
/// may abort the process or corrupt its memory. Throws InputError.
LightGrid parse_light_grid(const std::string& bytes, const std::string& name);
/// The file as .vdb bytes, with the scene's +Y as up or rotated for viewers whose up is +Z; either
/// way it is read as the same grid. Reading may reorder lines and rounds positions to floats
/// relative to their voxel.
std::string light_grid_bytes(const LightGrid& grid, bool z_up = false);

}  // namespace tdpt
