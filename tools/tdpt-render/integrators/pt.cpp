#include "tools/tdpt-render/integrators/integrator.h"

namespace tdpt {

/// Path tracing: walk from the camera until a light is met.
const Integrator pt{"pt", 1, TechniqueSet(Technique::camera), [](PathSampler& sample) {
                      sample.walk_from_camera();
                      sample.camera();
                    }};

}  // namespace tdpt
