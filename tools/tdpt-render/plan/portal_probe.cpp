#include "tools/tdpt-render/plan/portal_probe.h"

#include "libcommon/math/streams.h"
#include "libcommon/math/warp.h"

namespace tdpt {
namespace {

constexpr uint64_t kWalks = 800;
// The first steps are too near the portal to measure the size of the room.
constexpr int kSteps = 8, kSkipped = 2;

}  // namespace

double probed_conductance(const World& world, const Portal& portal) {
  Portal one_way = portal;
  one_way.both_ways = false;
  const PortalSet opening({one_way}, world.scene.frame);
  if (opening.empty()) return 0;
  double narrowest = 0;
  for (const uint64_t to_camera : {0, 1}) {
    uint64_t crossed = 0, bounces = 0;
    for (uint64_t i = 0; i < kWalks; ++i) {
      Rng rng(*kPortalProbe.seed, kPortalProbe.first + to_camera, i);
      const PortalSet::Sample start = opening.sample(rng);
      Tracer::Origin from{start.position};
      Vec3d w = to_camera ? start.direction : -start.direction;
      for (int step = 0; step < kSteps; ++step) {
        Hit hit;
        if (!world.tracer.closest(from, w, hit)) break;
        if (step >= kSkipped) {
          ++bounces;
          const bool crosses = to_camera ? opening.density(hit.position, from.position) > 0
                                         : opening.density(from.position, hit.position) > 0;
          crossed += crosses;
          if (crosses) break;
        }
        const Vec3d n = dot(hit.normal, w) < 0 ? hit.normal : -hit.normal;
        from = {hit.position, n};
        const double u = rng.uniform(), v = rng.uniform();
        w = Onb<double>(n).to_world(cosine_hemisphere(u, v));
      }
    }
    if (bounces > 0)
      narrowest = std::max(narrowest, static_cast<double>(crossed) / static_cast<double>(bounces));
  }
  return narrowest;
}

}  // namespace tdpt
