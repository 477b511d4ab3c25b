// The light grid (section 4.2): lines of light between pivot patches, counted in voxels of air.
#pragma once
#include <functional>

#include "libcommon/base/process.h"
#include "libcommon/formats/cut.h"
#include "libcommon/formats/light_grid.h"
#include "libcommon/math/reach.h"
#include "libcommon/scene/scene.h"
#include "tools/lightgrid/line_tracer.h"

namespace tdpt {

struct LightGridOptions {
  int resolution = 128;  ///< voxels along the longest side of the grid
  uint64_t seed = 1;
  uint64_t samples = 1 << 20;  ///< maximum number of segments between pivot patches
  double tolerance = 0.1;      ///< change of the normalised counts below which they have settled
  size_t lines = 8192;         ///< maximum number of lines in the file
  /// The user's own lines, used instead of segments between pivot patches; all are kept. Empty:
  /// segments are sampled.
  std::vector<LightLine> own;
};

/// Callbacks while segments are sampled.
struct LightGridWatch {
  std::function<void(uint64_t)> progress;  ///< receives the number of segments since the last call
  std::function<bool()> stop;              ///< whether to stop with the segments so far
};

/// Statistics of both passes for one cut.
struct PassStatistics {
  uint64_t drawn = 0, visible = 0, kept = 0;  ///< segments between pivot patches
  size_t batches = 0;
  bool settled = false;            ///< false: the budget ran out first
  double change = 1;               ///< of the normalised counts in the last batch
  uint64_t tried = 0, joined = 0;  ///< lines through the fullest voxels
  size_t lines = 0;                ///< kept in the file
};

struct LightGridReport {
  bool stopped = false;              ///< stopped by the callback
  float fullest = 0;                 ///< largest count of a voxel
  size_t air = 0;                    ///< voxels of air
  std::vector<PassStatistics> cuts;  ///< per cut; without pivot pairs nothing is sampled
  Phases phases;                     ///< air, patches, bvh, coarse, fine

  /// Sums over the cuts; the largest change, and whether all that were sampled have settled.
  PassStatistics all() const;
};

/// Makes the tracer of the lines.
using MakeLineTracer = std::function<std::unique_ptr<LineTracer>(const Scene&, const LineTables&,
                                                                 const LightGrid&, uint64_t seed)>;

/// Bounding box of all triangles, canonical.
Extent box_of(const Scene& scene);
/// Where the grid of a cut lies, canonical: the box that contains most of its patches (reach.h;
/// patches are small where walks were frequent), within the scene's box. For a cut with a sky only
/// the patches of the rooms count, with some air around.
Extent reach_of_cut(const Scene& scene, const CutFile& cut);
/// A box of a scene as cubic voxels, `resolution` along its longest side; without air and counts.
/// Throws UsageError if they, and what counts lines in them, take more than memory_limit().
LightGrid empty_grid(const Scene& scene, const Extent& box, int resolution);
inline LightGrid empty_grid(const Scene& scene, int resolution) {
  return empty_grid(scene, box_of(scene), resolution);
}

/// The grid of `scene` and `cut`; `cut_name` is used in error messages. Throws InputError if the
/// two do not belong together. A cut without a bottleneck, or without any line of light, gives a
/// grid whose `bottleneck` is false.
LightGrid make_light_grid(const Scene& scene, const CutFile& cut, const std::string& cut_name,
                          const LightGridOptions& options, LightGridReport& report,
                          const LightGridWatch& watch = {},
                          const MakeLineTracer& make_tracer = make_embree_lines);

// What the grid keeps of the building (building.cpp): the voxels free of geometry, the directions
// in which its walls face, and the sheets of solid glass in its windows.

/// "Air" in section 4.2, by conservative voxelisation of the triangles with the separating-axis
/// test. Sets grid.air to 1 where no triangle of the scene touches the voxel, 0 elsewhere.
/// Conservative: a triangle that only touches the voxel's boundary counts, too.
void mark_air(const Scene& scene, LightGrid& grid);

/// Whether a triangle touches the axis-aligned box with half side lengths `half` around the origin
/// (separating axes, Akenine-Moeller 2001).
bool triangle_touches_box(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& half);

/// Normals, of one of both sides, that at least 2 % of the surface in the grid's box has within two
/// degrees: of walls, floors and roofs, not of round or grown things. The most surface first; then
/// those at right angles to two of them.
std::vector<Vec3d> wall_directions(const Scene& scene, const LightGrid& grid);

/// Solids of glass between two parallel planes that are less than half as thick as wide; glass that
/// is curved or a sheet without thickness is none. The largest first, at most kMostPanes. Faces
/// must point out of the glass.
std::vector<GridPane> solid_panes(const Scene& scene);

// The fine pass (line_walk.cpp): a reversible Markov chain over the lines that connect the two
// sides of a cut.

struct LineWalk {
  std::vector<LightLine> lines;    ///< distributed by etendue, as far as the votes accept them
  std::vector<Probe> probes;       ///< the last line that each chain tried in a random direction
  uint64_t tried = 0, joined = 0;  ///< number of such lines, and how many connect the two sides
};

/// Lines of cut `c` and their probes. `count`: from the coarse pass, per voxel of `grid`; `kept`:
/// its lines, at least one. Returns at most `most` lines, labelled with the cut.
LineWalk walk_among_lines(const Scene& scene, LineTracer& tracer, size_t c, const LightGrid& grid,
                          const std::vector<uint32_t>& count, const std::vector<LightLine>& kept,
                          size_t most, uint64_t seed);

}  // namespace tdpt
