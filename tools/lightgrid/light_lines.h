// Lines of light that join the two sides of a cut: drawn between pivot patches, or through a place
// in the air.
#pragma once
#include <memory>
#include <optional>

#include "libcommon/formats/cut.h"
#include "libcommon/formats/light_grid.h"
#include "libcommon/scene/scene.h"
#include "libcommon/trace/tracer.h"
#include "tools/lightgrid/patch_map.h"

namespace tdpt {

/// A line from the source side of a cut to its sink side with the surfaces it ends on; canonical.
struct JoiningLine {
  SurfacePoint light, camera;
};

inline LightLine in_metres(const Scene& scene, const JoiningLine& l) {
  return {scene.frame.to_metres(l.light.position), scene.frame.to_metres(l.camera.position)};
}

class LightLines {
 public:
  /// Keeps references. Throws InputError (see PatchMap).
  LightLines(const Scene& scene, const Tracer& tracer, const CutFile& cut,
             const std::string& cut_name);

  /// Whether any pair of cut `c` has surface to draw from.
  bool empty(size_t c) const { return of_cut_[c].arcs.empty(); }

  enum class Fate { blocked, leak, kept };
  /// Draws a pair of cut `c` in proportion to its capacity and a point, uniform by area, on each of
  /// its patches. `leak`: visible, but one of its ends lies on the other side of the opening.
  Fate between_pivots(size_t c, Rng& rng, JoiningLine& line) const;

  enum class Through { unknown, same_side, joins };
  /// The line through canonical `place` along unit `w`, both ways to the first surface. `unknown`:
  /// it leaves the scene or ends on a surface without a patch. `joins`: its ends lie on different
  /// sides of cut `c`. If known, `line` holds it, turned from light to camera when it joins.
  Through through(size_t c, Rng& rng, const Vec3d& place, const Vec3d& w, JoiningLine& line) const;

 private:
  bool sees_its_side(size_t c, Rng& rng, const SurfacePoint& end, Side side) const;

  struct End {
    SurfacePoint point;
    uint32_t region;
  };
  std::optional<End> end_of(const Vec3d& place, const Vec3d& w) const;

  const Tracer& tracer_;
  const CutFile& cut_;
  PatchMap map_;
  std::vector<std::unique_ptr<PatchSurface>> surfaces_;  // per patch, where an arc needs it
  struct Pairs {
    std::vector<uint32_t> arcs;
    AliasTable table;
  };
  std::vector<Pairs> of_cut_;
};

}  // namespace tdpt
