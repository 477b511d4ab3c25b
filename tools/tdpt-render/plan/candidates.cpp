#include "tools/tdpt-render/plan/candidates.h"

#include <algorithm>

#include "tools/tdpt-render/path/sample/light_vertex_cache.h"

namespace tdpt {
namespace {

constexpr double kAim = 0.4;

// Samples share their light walks. With a light walk per sample bdpt took 1.07 to 1.5 times the
// work for the same error in twenty scenes with doors, windows and neither; plain bdpt is kept for
// caustics.
void few_light_walks(Mixture& m) {
  m.light_walks = kFewLightWalks;
}
// Next events as without portals.
void look_everywhere(Mixture& m) {
  m.through_windows = 0;
}
// With camera walks guided to portals: much of a sky's light is reflected by the ground outside,
// where no next event looks.
void aim(Mixture& m) {
  m.guiding.chance = {0, kAim};
}

Integrator variant(Integrator integrator, uint64_t stream,
                   std::initializer_list<void (*)(Mixture&)> changes) {
  integrator.stream = stream;
  for (const auto change : changes) change(integrator.mixture);
  return integrator;
}

}  // namespace

std::vector<Candidate> possible_candidates(const Vista& vista, const Integrator& guided) {
  std::vector<Candidate> all{
      {variant(bdpt, stream::bdpt_with_few_light_walks, {few_light_walks, look_everywhere}),
       "bdpt with few light walks"},
      {variant(nee, nee.stream, {look_everywhere}), "nee"},
      {variant(bdpt, bdpt.stream, {look_everywhere}), "bdpt"}};
  // Others were best in next to none of 70 views, and each more is chosen by chance at times:
  // tdpt-org, more or fewer segments, next events that weigh as in tdpt-guided, and bdpt and nee
  // whose next events look through windows.
  if (!vista.openings.portals.empty())
    all.insert(all.begin(),
               {guided, guided.mixture == tdpt_guided.mixture ? guided.name : label_of(guided)});
  if (!vista.openings.windows.empty())
    all.push_back({variant(nee, stream::nee_guided_to_windows, {aim}), "nee guided to windows"});
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
