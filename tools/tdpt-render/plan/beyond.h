// How much light a picture of limited depth leaves out.
#pragma once
#include <string>

#include "tools/tdpt-render/integrators/passes.h"

namespace tdpt {

/// Light of paths of more than `depth` edges.
struct Beyond {
  int depth = 0;
  double share = 0;  ///< of all light, [0,1]
  double error = 0;  ///< standard error of the share
};

/// Tells it from some samples without limit, spread over the picture, which are thrown away: about
/// `samples`, 64 to 16384. They are left in `film`.
Beyond light_beyond(const World& world, const Integrator& integrator, const SampleRules& rules,
                    double samples, Film& film);

/// "depth 6 leaves out about 25 % of the light".
std::string sentence(const Beyond& beyond);

}  // namespace tdpt
