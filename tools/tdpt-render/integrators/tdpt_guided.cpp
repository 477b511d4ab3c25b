#include "tools/tdpt-render/integrators/integrator.h"

namespace tdpt {
namespace {

// The techniques of tdpt-org with both walks directed at the portals. [guide.h]
constexpr Integrator guided(uint64_t stream, const Guiding& guiding, double segments) {
  return {"tdpt-guided", stream,
          TechniqueSet(Technique::camera, Technique::direct, Technique::light, Technique::bi,
                       Technique::portal)
              .favouring_direct(6, 2)
              .with_segments(segments),
          [](PathSampler& sample) {
            sample.walk_from_camera();
            sample.walk_from_light();
            sample.camera();
            sample.direct();
            sample.light();
            sample.bi();
            sample.portal();
          },
          guiding};
}

}  // namespace

const Integrator tdpt_guided = guided(6, {{0.5, 0.4}}, 1);
const Integrator tdpt_guided_more = guided(7, {{0.7, 0.5}}, 1);
const Integrator tdpt_guided_less = guided(8, {{0.5, 0.2}}, 0.25);

}  // namespace tdpt
