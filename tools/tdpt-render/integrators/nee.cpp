#include "tools/tdpt-render/integrators/integrator.h"

namespace tdpt {

/// Path tracing with next-event estimation at every vertex.
const Integrator nee{"nee", 2, TechniqueSet(Technique::camera, Technique::direct),
                     [](PathSampler& sample) {
                       sample.walk_from_camera();
                       sample.camera();
                       sample.direct();
                     }};

}  // namespace tdpt
