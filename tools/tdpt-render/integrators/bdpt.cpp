#include "tools/tdpt-render/integrators/integrator.h"

namespace tdpt {

/// Bidirectional path tracing (Veach).
const Integrator bdpt{
    "bdpt", 3, TechniqueSet(Technique::camera, Technique::direct, Technique::light, Technique::bi),
    [](PathSampler& sample) {
      sample.walk_from_camera();
      sample.walk_from_light();
      sample.camera();
      sample.direct();
      sample.light();
      sample.bi();
    }};

}  // namespace tdpt
