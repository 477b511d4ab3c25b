#include "tools/tdpt-render/plan/candidates.h"

#include <algorithm>

#include "tools/tdpt-render/path/sample/light_vertex_cache.h"

namespace tdpt {
namespace {

constexpr double kAim = 0.4;

// Samples share their light walks. With a light walk per sample bdpt took 1.07 to 1.5 times the
// work for the same error in twenty scenes with doors, windows and neither; plain bdpt is kept for
// caustics.
Integrator few(Integrator integrator, uint64_t stream) {
  integrator.stream = stream;
  integrator.mixture.light_walks = kFewLightWalks;
  return integrator;
}

// Next events as without portals.
Integrator looking_everywhere(Integrator integrator) {
  integrator.mixture.through_windows = 0;
  return integrator;
}

// With tdpt-guided's sample weights of next events: tdpt-guided without its portal techniques.
Integrator favouring_next_events(Integrator integrator) {
  integrator.mixture.first_direct = tdpt_guided.mixture.first_direct;
  integrator.mixture.later_direct = tdpt_guided.mixture.later_direct;
  return integrator;
}

Integrator with_stream(Integrator integrator, uint64_t stream) {
  integrator.stream = stream;
  return integrator;
}

// With camera walks guided to portals: much of a sky's light is reflected by the ground outside,
// where no next event looks.
Integrator aiming(Integrator integrator, uint64_t stream) {
  integrator.stream = stream;
  integrator.mixture.guiding.chance = {0, kAim};
  return integrator;
}

}  // namespace

std::vector<Candidate> possible_candidates(const Vista& vista, const Integrator& guided) {
  const Integrator plain = looking_everywhere(few(bdpt, stream::bdpt_with_few_light_walks));
  std::vector<Candidate> all{
      {plain, "bdpt with few light walks"},
      {looking_everywhere(nee), "nee"},
      {with_stream(favouring_next_events(plain), stream::bdpt_favouring_next_events),
       "bdpt favouring next events"},
      {looking_everywhere(bdpt), "bdpt"}};
  // tdpt-org, and tdpt-guided with more or fewer segments, were never much better in forty rooms
  // and seventeen views of others, and choosing among them by chance cost up to half.
  if (!vista.openings.portals.empty())
    all.push_back({guided, guided.mixture == tdpt_guided.mixture ? guided.name : label_of(guided)});
  if (!vista.openings.windows.empty()) {
    all.push_back({few(bdpt, stream::bdpt_through_windows), "bdpt through windows"});
    all.push_back({with_stream(nee, stream::nee_through_windows), "nee through windows"});
    all.push_back({aiming(few(bdpt, 0), stream::bdpt_guided_to_windows), "bdpt guided to windows"});
    all.push_back({aiming(nee, stream::nee_guided_to_windows), "nee guided to windows"});
  }
  return all;
}

std::vector<Candidate> auto_candidates(const Vista& vista, const Integrator& guided) {
  const std::vector<Candidate> all = possible_candidates(vista, guided);
  std::vector<Candidate> candidates;
  for (const Candidate& c : all)
    if (light_missed(c.integrator, vista.world->scene).empty()) candidates.push_back(c);
  // If all miss some light, the first misses least.
  if (candidates.empty()) candidates.push_back(all.front());
  return candidates;
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
