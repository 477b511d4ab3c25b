#include "tools/tdpt-render/integrators/integrator.h"

namespace tdpt {

/// The techniques of tdpt-org with both walks directed at the portals. [guide.h]
const Integrator tdpt_guided{"tdpt-guided",
                             6,
                             TechniqueSet(Technique::camera, Technique::direct, Technique::light,
                                          Technique::bi, Technique::portal)
                                 .favouring_direct(6, 2),
                             [](PathSampler& sample) {
                               sample.walk_from_camera();
                               sample.walk_from_light();
                               sample.camera();
                               sample.direct();
                               sample.light();
                               sample.bi();
                               sample.portal();
                             },
                             {{0.5, 0.4}}};

}  // namespace tdpt
