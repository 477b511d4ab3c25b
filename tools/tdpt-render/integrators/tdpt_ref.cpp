#include "tools/tdpt-render/integrators/integrator.h"

namespace tdpt {

/// Portal segments in place of the bi-connections: the paper's refined TDPT, section 3.
const Integrator tdpt_ref{
    "tdpt", 5,
    TechniqueSet(Technique::camera, Technique::direct, Technique::light, Technique::portal),
    [](PathSampler& sample) {
      sample.walk_from_camera();
      sample.walk_from_light();
      sample.camera();
      sample.direct();
      sample.light();
      sample.portal();
    }};

}  // namespace tdpt
