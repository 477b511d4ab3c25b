#include "tools/tdpt-render/plan/portal_ways.h"

#include <algorithm>

#include "libcommon/math/rng.h"
#include "libcommon/math/streams.h"

namespace tdpt {
namespace {

constexpr double kLeastEnergy = 0.001;  // share of the picture's light
constexpr double kEarnest = 0.2;        // share of the light through the portal
constexpr double kWideWay = 0.066;      // conductance
// Walks of the probe. The first steps are too near the portal to measure the size of the room.
constexpr uint64_t kWalks = 800;
constexpr int kSteps = 8, kSkipped = 2;

}  // namespace

PortalWay way_of(bool drawn_both_ways, const std::array<double, 2>& passed,
                 const std::array<double, 2>& sure, double total, bool wide) {
  if (!(std::max(sure[0], sure[1]) > kLeastEnergy * total)) return PortalWay::as_drawn;
  const double least = kEarnest * (passed[0] + passed[1]);
  if (sure[1] > least && passed[0] < least) return PortalWay::back;
  if (drawn_both_ways) {
    if (sure[0] > least && passed[1] < least) return PortalWay::front;
    if (wide) return passed[0] < passed[1] ? PortalWay::back : PortalWay::front;
    return PortalWay::as_drawn;
  }
  return sure[1] > least && !wide ? PortalWay::both : PortalWay::as_drawn;
}

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

bool is_wide(const World& world, const Portal& portal) {
  return probed_conductance(world, portal) > kWideWay;
}

void apply_ways(const std::vector<PortalWay>& ways, std::vector<Portal>& portals) {
  for (size_t i = 0; i < ways.size(); ++i) {
    Portal& portal = portals.at(i);
    if (ways[i] == PortalWay::as_drawn) continue;
    if (ways[i] == PortalWay::left_out) {
      portal.figures.emplace("area", area_of(portal));
      portal.triangles.clear();
      continue;
    }
    portal.both_ways = ways[i] == PortalWay::both;
    if (ways[i] == PortalWay::back)
      for (auto& t : portal.triangles) std::swap(t[1], t[2]);
  }
}

}  // namespace tdpt
