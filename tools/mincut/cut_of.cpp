#include "tools/mincut/cut_of.h"

#include <atomic>
#include <iterator>

#include <fmt/format.h>

#include "libcommon/formats/format_version.h"
#include "tools/mincut/verify.h"

namespace tdpt {

namespace {

// The camera's light that each node scatters: beside a landscape rooms have little surface, and the
// sky scatters nothing.
std::vector<double> scattered(const PatchNetwork& p) {
  std::vector<double> light(p.network.nodes, 0);
  for (uint32_t v = 0; v < p.network.nodes; ++v)
    if (!p.is_sky(v)) light[v] = p.samples[v] * p.brightness[v] * p.importance[v];
  return light;
}

}  // namespace

FoundCuts cut_of(const DimacsFile& problem, size_t most, const CutLimits& limits) {
  FoundCuts found;
  CutFile& cut = found.file;
  cut.scene_hash = problem.scene_hash;
  cut.camera = problem.camera;
  cut.grid = problem.grid;
  cut.patches = problem.patches;
  cut.light = problem.light;
  PatchNetwork patches{problem.network, std::vector<double>(problem.network.nodes, 0),
                       problem.scale};
  const bool walks = !problem.walks.empty();
  if (walks) patches.begun = patches.lit = patches.viewed = patches.samples;
  constexpr uint32_t kNone = UINT32_MAX;
  std::vector<uint32_t> patch_of(problem.network.nodes, kNone);
  for (uint32_t i = 0; i < cut.patches.size(); ++i) {
    patch_of[cut.patches[i].node - 1] = i;
    const uint32_t node = cut.patches[i].node - 1;
    patches.samples[node] = cut.patches[i].samples;
    if (cut.patches[i].is_sky())
      patches.sky.resize(problem.network.nodes, 0), patches.sky[node] = 1;
    if (!problem.light.empty()) {
      patches.brightness.resize(problem.network.nodes, 0);
      patches.importance.resize(problem.network.nodes, 0);
      patches.brightness[node] = problem.light[i].brightness;
      patches.importance[node] = problem.light[i].importance;
    }
    if (!walks) continue;
    patches.begun[node] = problem.walks[i].begun;
    patches.lit[node] = problem.walks[i].light;
    patches.viewed[node] = problem.walks[i].camera;
  }
  if (!patches.sky.empty() && !problem.light.empty()) patches.weight = scattered(patches);
  std::atomic<size_t> flows = 0;
  SeriesCut series = series_cut(patches, most, limits, [&](const FlowNetwork& network) {
    ++flows;
    MaxFlow flow = max_flow(network);
    verify_max_flow(network, flow);
    return flow;
  });
  for (const Patch& p : cut.patches) cut.region.push_back(series.region[p.node - 1]);
  for (const SeriesCut::Cut& c : series.cuts)
    found.facts.push_back(c.facts),
        cut.cuts.push_back({static_cast<double>(c.flow) / problem.scale, c.facts.conductance});
  for (const FlowArc& a : problem.network.arcs) {
    const uint32_t from = patch_of[a.from], to = patch_of[a.to];
    if (from == kNone || to == kNone || a.capacity == 0) continue;
    if (cut.region[from] < cut.region[to])
      cut.arcs.push_back({from, to, static_cast<double>(a.capacity) / problem.scale});
  }
  cut.bottleneck = series.bottleneck;
  cut.reason = series.reason;
  found.refused = std::move(series.refused);
  found.drops = series.drops;
  found.passed = series.passed;
  found.closets = series.closets;
  found.flows = flows;
  return found;
}

std::string plain_cut_text(const DimacsFile& problem, const MaxFlow& flow,
                           const Provenance& provenance) {
  std::string out = fmt::format("c tdpt cut {}\n", format_version::cut);
  const auto to = std::back_inserter(out);
  for (const std::string& line : provenance.lines) fmt::format_to(to, "c {}\n", line);
  fmt::format_to(to, "s {}\n", flow.value);
  for (uint32_t v = 0; v < problem.network.nodes; ++v)
    fmt::format_to(to, "n {} {}\n", v + 1, flow.source_side[v] ? 's' : 't');
  for (const FlowArc& a : problem.network.arcs)
    if (flow.source_side[a.from] && !flow.source_side[a.to])
      fmt::format_to(to, "a {} {} {}\n", a.from + 1, a.to + 1, a.capacity);
  return out;
}

}  // namespace tdpt
