#include "tools/tdpt-render/plan/candidates.h"

#include <algorithm>

#include "tools/tdpt-render/path/sample/light_vertex_cache.h"

namespace tdpt {
namespace {

constexpr double kAim = 0.4;

// Next events look everywhere, as without portals.
Integrator without_windows(Integrator integrator, uint64_t stream) {
  integrator.stream = stream;
  integrator.mixture.through_windows = 0;
  return integrator;
}

}  // namespace

std::vector<Candidate> auto_candidates(const Vista& vista, const Integrator& guided) {
  // Others were best in next to none of 70 views, and each more is chosen by chance at times:
  // tdpt-org, more or fewer segments, next events that weigh as in tdpt-guided, and bdpt and nee
  // whose next events look through windows.
  std::vector<Candidate> all;
  if (!vista.openings.portals.empty())
    all.push_back({guided, guided.mixture == tdpt_guided.mixture ? guided.name : label_of(guided)});
  // Samples share their light walks. With a light walk per sample bdpt took 1.07 to 1.5 times the
  // work for the same error in twenty scenes with doors, windows and neither; plain bdpt is kept
  // for caustics.
  Integrator few = without_windows(bdpt, stream::bdpt_with_few_light_walks);
  few.mixture.light_walks = kFewLightWalks;
  all.push_back({few, "bdpt with few light walks"});
  all.push_back({without_windows(nee, nee.stream), "nee"});
  all.push_back({without_windows(bdpt, bdpt.stream), "bdpt"});
  // Camera walks guided to portals: much of a sky's light is reflected by the ground outside, where
  // no next event looks.
  Integrator aimed = nee;
  aimed.stream = stream::nee_guided_to_windows;
  aimed.mixture.guiding.chance = {0, kAim};
  if (!vista.openings.windows.empty()) all.push_back({aimed, "nee guided to windows"});
  const Candidate first = all.front();  // if all miss some light, it misses least
  std::erase_if(all, [&](const Candidate& c) {
    return !light_missed(c.integrator, vista.world->scene).empty();
  });
  if (all.empty()) all.push_back(first);
  return all;
}

std::vector<Candidate> expecting_connections(const Vista& vista, std::vector<Candidate> candidates,
                                             int max_depth) {
  // Candidates with the same guiding have the same walks.
  std::vector<std::pair<Guiding, LightVertices>> known;
  for (Candidate& c : candidates) {
    Mixture& m = c.integrator.mixture;
    if (!m.techniques.walks_from_light()) continue;
    auto at = std::find_if(known.begin(), known.end(),
                           [&](const auto& k) { return k.first == m.guiding; });
    if (at == known.end())
      at = known.insert(at, {m.guiding, expected_light_vertices(vista, m.guiding, max_depth)});
    m = expecting_connections(at->second, m);
  }
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
