// Lines of light that come from infinity, for the walks of the light: which part of the sky they
// come from, and where they are aimed.
//
// A small window in a wide landscape is met by few lines that fall on all of it. So half of them
// are aimed at a ball about what the camera's walks reach, a quarter at a wider one, the others at
// the whole scene. And what the sun outshines has windows, too: half of the lines come from the sky
// in proportion to light, half from all bins of it that shine, by solid angle and grade.
#pragma once
#include <vector>

#include "libcommon/math/alias_table.h"
#include "libcommon/math/reach.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"
#include "libcommon/scene/sky_bins.h"

namespace tdpt {

/// Data terms of the bins of a sky: min(1, L_k / (0.5 L_med)), L_k = light_k / solid angle, L_med
/// the median of L over the bins that shine, weighted by solid angle.
std::vector<double> sky_grades(const std::vector<double>& light);

class SkyLines {
 public:
  struct Ball {
    Vec3d centre;  ///< canonical
    double radius;
  };

  /// `aims`: where the first half and the next quarter of the lines fall. `scene` is lit
  /// from infinity.
  SkyLines(const Scene& scene, const Extent& aim, const Extent& wider);

  struct Line {
    Vec3d origin, direction;  ///< canonical; outside the scene, unit
    uint32_t bin;             ///< that it comes from
  };
  Line draw(Rng& rng) const;

 private:
  Vec3d towards(Rng& rng) const;

  std::vector<Ball> balls_;      // aim, wider, all
  SkyDirections directions_;     // of the sky
  std::vector<Vec3d> parallel_;  // towards the lamps
  AliasTable lights_;            // the lamps, then the sky
  AliasTable bins_;              // by grade and solid angle
};

}  // namespace tdpt
