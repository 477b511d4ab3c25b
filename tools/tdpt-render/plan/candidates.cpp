#include "tools/tdpt-render/plan/candidates.h"

#include "tools/tdpt-render/path/sample/light_pool.h"

namespace tdpt {
namespace {

constexpr double kAim = 0.4;

// bdpt with tdpt-guided's sample weights of next events: what that is without portals, and with the
// same random numbers.
Integrator favouring_next_events() {
  Integrator integrator{"bdpt", kGuided[0].stream, kGuided[0].mixture};
  integrator.mixture.techniques = kTwoWays;
  integrator.mixture.guiding = {};
  return integrator;
}

// As without portals.
Integrator looking_everywhere(Integrator integrator) {
  integrator.mixture.through_windows = 0;
  return integrator;
}

// Its walks from the camera directed at portals: much of a sky's light comes off the ground
// outside, where no next event looks.
Integrator aiming(Integrator integrator, uint64_t stream) {
  integrator.stream = stream;
  integrator.mixture.guiding.chance = {0, kAim};
  return integrator;
}

Integrator with_few_light_walks(Integrator integrator, uint64_t stream) {
  integrator.stream = stream;
  integrator.mixture.light_walks = kFewLightWalks;
  return integrator;
}

Integrator with_stream(Integrator integrator, uint64_t stream) {
  integrator.stream = stream;
  return integrator;
}

}  // namespace

std::vector<Candidate> possible_candidates(const World& world, std::span<const Integrator> guided) {
  std::vector<Candidate> all{
      {looking_everywhere(bdpt), label_of(bdpt)},
      {looking_everywhere(nee), label_of(nee)},
      {pt, label_of(pt)},
      {looking_everywhere(favouring_next_events()), "bdpt favouring next events"}};
  const Integrator few_light_walks =
      with_few_light_walks(looking_everywhere(bdpt), stream::bdpt_with_few_light_walks);
  all.push_back({few_light_walks, label_of(few_light_walks)});
  if (!world.portals.empty()) {
    all.push_back({tdpt_org, label_of(tdpt_org)});
    for (const Integrator& integrator : guided) all.push_back({integrator, label_of(integrator)});
  }
  if (!world.windows.empty()) {
    all.push_back({with_stream(bdpt, stream::bdpt_through_windows), "bdpt through windows"});
    all.push_back({with_stream(nee, stream::nee_through_windows), "nee through windows"});
    for (const Integrator& integrator :
         {aiming(bdpt, stream::bdpt_aiming), aiming(nee, stream::nee_aiming)})
      all.push_back({integrator, label_of(integrator)});
  }
  return all;
}

std::vector<Candidate> auto_candidates(const World& world, std::span<const Integrator> guided) {
  const std::vector<Candidate> all = possible_candidates(world, guided);
  std::vector<Candidate> candidates;
  for (const Candidate& c : all)
    if (light_missed(c.integrator, world.scene).empty()) candidates.push_back(c);
  // Where each misses some, the first misses least.
  if (candidates.empty()) candidates.push_back(all.front());
  return candidates;
}

std::vector<Candidate> expecting_joins(const World& world, std::vector<Candidate> candidates,
                                       int max_depth) {
  for (Candidate& c : candidates)
    c.integrator.mixture = expecting_joins(world, c.integrator.mixture, max_depth);
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
