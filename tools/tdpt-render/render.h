// The loop over pixels and samples.
#pragma once
#include <string>

#include "tools/tdpt-render/integrators/integrator.h"

namespace tdpt {

struct RenderSettings {
  uint64_t spp = 0;    ///< samples per pixel; 0: as many as fit into `seconds`
  double seconds = 0;  ///< wall-clock limit of rendering alone; 0: none
  int max_depth = 6;
  double beta = 1;  ///< 1: balance heuristic, 2: power heuristic
  uint64_t seed = 1;
  bool quiet = true;
};

struct RenderResult {
  Picture picture;
  uint64_t spp = 0;  ///< samples each pixel got
  double seconds = 0, cpu_seconds = 0;
  bool interrupted = false;  ///< a signal ended it early; the picture holds what was there
  Tally tally;

  Vec3d mean() const;      ///< over all pixels
  double nonzero() const;  ///< share of pixels that are not black
};

/// Renders in passes over the whole picture, so every pixel has the same number of samples whenever
/// it stops. The picture is a function of (scene, settings, spp) alone.
RenderResult render(const World& world, const Integrator& integrator,
                    const RenderSettings& settings);

}  // namespace tdpt
