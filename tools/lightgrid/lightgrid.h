// The light grid (section 4.2): lines of light between pivot patches, counted in voxels of air.
#pragma once
#include <functional>

#include "libcommon/base/phases.h"
#include "libcommon/formats/cut.h"
#include "libcommon/formats/light_grid.h"
#include "libcommon/math/reach.h"
#include "libcommon/scene/scene.h"
#include "tools/lightgrid/embree_lines.h"

namespace tdpt {

struct LightGridOptions {
  int resolution = 128;  ///< voxels along the longest side of the grid
  uint64_t seed = 1;
  uint64_t samples = 1 << 20;  ///< most segments drawn between pivot patches
  double tolerance = 0.04;     ///< change of the normalised counts that counts as settled
  size_t lines = 8192;         ///< lines to keep in the file
  /// One's own lines, in place of segments between pivot patches; all are kept. Empty: they are
  /// drawn.
  std::vector<LightLine> own;
};

/// What a caller may want to know or say while segments are drawn.
struct LightGridWatch {
  std::function<void(uint64_t)> progress;  ///< segments drawn since the last call
  std::function<bool()> stop;              ///< whether to go on with what there is
};

struct LightGridReport {
  /// Both passes for one cut.
  struct OfCut {
    uint64_t drawn = 0, visible = 0, kept = 0;
    size_t batches = 0;
    bool settled = false;
    double change = 1;
    uint64_t tried = 0, joined = 0;
    size_t lines = 0;  ///< kept in the file
  };
  bool stopped = false;                       ///< the watch said stop
  uint64_t drawn = 0, visible = 0, kept = 0;  ///< segments between pivot patches
  bool settled = false;                       ///< false: the budget was spent first
  double change = 1;                          ///< of the normalised counts in the last batch
  uint64_t tried = 0, joined = 0;             ///< lines through the fullest places
  float fullest = 0;                          ///< largest count of a voxel
  size_t air = 0;                             ///< voxels of air
  std::vector<OfCut> cuts;                    ///< of each cut; without pivot pairs nothing is drawn
  Phases phases;                              ///< air, patches, bvh, coarse, fine
};

/// What makes the tracer of the lines.
using MakeLineTracer = std::function<std::unique_ptr<LineTracer>(const Scene&, const LineTables&,
                                                                 const LightGrid&, uint64_t seed)>;

/// The box of all triangles, canonical.
Extent box_of(const Scene& scene);
/// Where the grid of a cut lies, canonical: the box that most of its patches reach (reach.h), which
/// are small where walks came often, as far as that lies in the box of the scene. Of a cut with a
/// sky those of the rooms alone, with some air around.
Extent reach_of_cut(const Scene& scene, const CutFile& cut);
/// A box of a scene in cubic voxels, `resolution` along its longest side; no air, no counts.
LightGrid empty_grid(const Scene& scene, const Extent& box, int resolution);
inline LightGrid empty_grid(const Scene& scene, int resolution) {
  return empty_grid(scene, box_of(scene), resolution);
}

/// The grid of `scene` and `cut`; `cut_name` stands in error messages. Throws InputError when the
/// two do not belong together. A cut without a bottleneck, or one without a line of light, gives a
/// grid with bottleneck false.
LightGrid make_light_grid(const Scene& scene, const CutFile& cut, const std::string& cut_name,
                          const LightGridOptions& options, LightGridReport& report,
                          const LightGridWatch& watch = {},
                          const MakeLineTracer& make_tracer = make_embree_lines);

}  // namespace tdpt
