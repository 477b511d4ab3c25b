// What is asked of the renderer: parsed and checked once.
#pragma once
#include <cstdint>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/path/sample/roulette.h"

namespace tdpt {

/// What ends a rendering; 0: no such limit.
struct Limits {
  uint64_t spp = 0;         ///< samples per pixel; 0: what fits into `seconds`, or the target needs
  double seconds = 0;       ///< wall-clock limit of rendering alone
  double target_error = 0;  ///< relMSE to reach, within the limits of spp and seconds
  bool retry = false;       ///< if the target is missed, continue once
  friend bool operator==(const Limits&, const Limits&) = default;
};

struct Job {
  Limits limits;
  bool automatic = false;           ///< the pilot chooses the integrator [pilot.h]
  Integrator named = bdpt;          ///< renders if not automatic
  Integrator guided = tdpt_guided;  ///< `auto` tries it, with the numbers given
  int max_depth = kMaxDepth;        ///< edges
  double beta = 1;                  ///< 1: balance heuristic, 2: power heuristic
  uint64_t seed = 1;
  bool quiet = true;
  bool alpha = false;   ///< transparent film: the sky in the background is left out
  bool layers = false;  ///< keep each technique's contribution apart
  bool halves = false;  ///< keep the samples with odd numbers apart
  bool frames = false;  ///< measure the unfinished picture
};

}  // namespace tdpt
