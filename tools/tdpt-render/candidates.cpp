#include "tools/tdpt-render/candidates.h"

namespace tdpt {
namespace {

// bdpt with tdpt-guided's sample weights of next events: what that is without portals.
Integrator favouring_next_events() {
  Integrator integrator{"bdpt", kGuided[0].stream, kGuided[0].mixture};
  integrator.mixture.techniques = kTwoWays;
  integrator.mixture.guiding = {};
  return integrator;
}

}  // namespace

std::vector<Candidate> auto_candidates(const World& world, std::span<const Integrator> guided) {
  std::vector<Candidate> all{{bdpt, label_of(bdpt)},
                             {nee, label_of(nee)},
                             {pt, label_of(pt)},
                             {favouring_next_events(), "bdpt favouring next events"}};
  if (!world.portals.empty()) {
    all.push_back({tdpt_org, label_of(tdpt_org)});
    for (const Integrator& integrator : guided) all.push_back({integrator, label_of(integrator)});
  }
  std::vector<Candidate> candidates;
  for (const Candidate& c : all)
    if (light_missed(c.integrator, world.scene).empty()) candidates.push_back(c);
  // Where each misses some, the first misses least.
  if (candidates.empty()) candidates.push_back(all.front());
  return candidates;
}

Integrator either_of(const std::vector<Candidate>& candidates) {
  Integrator any = candidates.front().integrator;
  any.name = "auto";
  TechniqueSet& all = any.mixture.techniques;
  for (const Candidate& c : candidates) all = all | c.integrator.mixture.techniques;
  return any;
}

}  // namespace tdpt
