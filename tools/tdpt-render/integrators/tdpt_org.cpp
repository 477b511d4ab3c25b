#include "tools/tdpt-render/integrators/integrator.h"

namespace tdpt {

/// Bidirectional path tracing and portal segments on top: the paper's TDPT-ORG, each split once.
const Integrator tdpt_org{"tdpt-org", 4,
                          TechniqueSet(Technique::camera, Technique::direct, Technique::light,
                                       Technique::bi, Technique::portal),
                          [](PathSampler& sample) {
                            sample.walk_from_camera();
                            sample.walk_from_light();
                            sample.camera();
                            sample.direct();
                            sample.light();
                            sample.bi();
                            sample.portal();
                          }};

}  // namespace tdpt
