// Light from infinity for the light walks: which part of the sky a line comes from, and where it is
// aimed.
//
// A small window in a wide landscape would be hit by few of the lines spread over all of it. So
// half of the lines are aimed at a ball around what the camera walks reach, a quarter at a wider
// one, the rest at the whole scene. Windows that face away from the sun count, too: half of the
// lines come from the sky in proportion to light, half from all bins that shine, by solid angle and
// grade.
#pragma once
#include <vector>

#include "libcommon/math/alias_table.h"
#include "libcommon/math/reach.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"
#include "libcommon/scene/sky_bins.h"

namespace tdpt {

/// Unary terms of the bins of a sky: min(1, L_k / (0.5 L_med)), L_k = light_k / solid angle, L_med
/// the median of L over the bins that shine, weighted by solid angle.
std::vector<double> sky_grades(const std::vector<double>& light);

class SkyLines {
 public:
  struct Ball {
    Vec3d centre;  ///< canonical
    double radius;
  };

  /// `aim`, `wider`: targets of the first half and the next quarter of the lines. `scene` must be
  /// lit from infinity.
  SkyLines(const Scene& scene, const Extent& aim, const Extent& wider);

  struct Line {
    Vec3d origin, direction;  ///< canonical; outside the scene, unit
    uint32_t bin;             ///< where it comes from
    double power;             ///< luminance / density of the line: the light it stands for
  };
  Line draw(Rng& rng) const;

 private:
  struct Towards {
    Vec3d w;
    double per_pdf;  ///< luminance / density of the direction [1/sr]; of a lamp its irradiance over
                     ///< its probability
  };
  Towards towards(Rng& rng) const;
  double density_across(const Vec3d& through, const Vec3d& w) const;

  std::vector<Ball> balls_;         // aim, wider, all
  SkyDirections directions_;        // of the sky
  std::vector<Vec3d> parallel_;     // directions towards the lamps
  std::vector<double> irradiance_;  // across them, luminance
  const Sky* sky_ = nullptr;
  AliasTable lights_;  // the lamps, then the sky
  AliasTable bins_;    // by grade and solid angle
};

}  // namespace tdpt
