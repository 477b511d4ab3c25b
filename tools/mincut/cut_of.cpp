#include "tools/mincut/cut_of.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "libcommon/base/error.h"
#include "libcommon/formats/format_version.h"

namespace tdpt {
namespace {

template <class... Args>
[[noreturn]] void refute(fmt::format_string<Args...> text, Args&&... args) {
  throw Error(Exit::internal, "the solver's answer does not hold: " +
                                  fmt::format(text, std::forward<Args>(args)...));
}

}  // namespace

void verify_max_flow(const FlowNetwork& network, const MaxFlow& result) {
  if (result.flow.size() != network.arcs.size())
    refute("{} flows, expected {}", result.flow.size(), network.arcs.size());
  if (result.source_side.size() != network.nodes)
    refute("{} sides, expected {}", result.source_side.size(), network.nodes);
  if (!result.source_side[network.source]) refute("the source is not on its own side");
  if (result.source_side[network.sink]) refute("the sink is on the source's side");
  std::vector<int64_t> surplus(network.nodes, 0);
  int64_t cut = 0;
  for (size_t i = 0; i < network.arcs.size(); ++i) {
    const FlowArc& a = network.arcs[i];
    const int64_t f = result.flow[i];
    if (f < 0 || f > a.capacity)
      refute("arc {} carries {}, expected 0 to {}", i + 1, f, a.capacity);
    surplus[a.from] -= f;
    surplus[a.to] += f;
    if (result.source_side[a.from] && !result.source_side[a.to]) cut += a.capacity;
  }
  for (uint32_t v = 0; v < network.nodes; ++v)
    if (v != network.source && v != network.sink && surplus[v] != 0)
      refute("node {} keeps {}, expected 0", v + 1, surplus[v]);
  if (surplus[network.sink] != result.value)
    refute("{} arrives at the sink, expected {}", surplus[network.sink], result.value);
  if (cut != result.value) refute("the cut holds {}, expected the flow {}", cut, result.value);
}

namespace {

// Beside a landscape rooms have little surface: under a sky the camera's light that a node scatters
// counts, too. The sky itself scatters nothing.
void weigh_by_light(PatchNetwork& p) {
  if (p.brightness.empty() || p.sky.empty()) return;
  p.weight.assign(p.network.nodes, 0);
  for (uint32_t v = 0; v < p.network.nodes; ++v)
    if (!p.is_sky(v)) p.weight[v] = p.samples[v] * p.brightness[v] * p.importance[v];
}

// The arcs between patches that cross some cut.
std::vector<CutArc> pivot_pairs(const DimacsFile& problem, const CutFile& cut) {
  constexpr uint32_t kNone = UINT32_MAX;
  std::vector<uint32_t> patch_of(problem.network.nodes, kNone);
  for (uint32_t i = 0; i < cut.patches.size(); ++i) patch_of[cut.patches[i].node - 1] = i;
  std::vector<CutArc> pairs;
  for (const FlowArc& a : problem.network.arcs) {
    const uint32_t from = patch_of[a.from], to = patch_of[a.to];
    if (from == kNone || to == kNone || a.capacity == 0) continue;
    const CutArc arc{from, to, static_cast<double>(a.capacity) / problem.scale};
    if (cut.crossed(arc) != 0) pairs.push_back(arc);
  }
  return pairs;
}

// Cut number `cut` of one camera's.
struct CutOf {
  uint32_t camera;
  size_t cut;
};

// The bottlenecks camera by camera, of each from the light to it; without any, the first camera's
// cut.
std::vector<CutOf> cuts_of_all(const std::vector<SeriesCut>& series) {
  std::vector<CutOf> all;
  for (uint32_t k = 0; k < series.size(); ++k)
    for (size_t c = 0; series[k].bottleneck && c < series[k].cuts.size(); ++c)
      all.push_back({k, c});
  if (all.empty()) all.push_back({0, 0});
  return all;
}

// Leaves at most `most` of them, in their order: the camera with most loses what promises least.
void keep_most_promising(std::vector<CutOf>& cuts, const std::vector<SeriesCut>& series,
                         size_t most) {
  std::vector<size_t> count(series.size(), 0);
  for (const CutOf& c : cuts) ++count[c.camera];
  const auto rank = [&](const CutOf& c) {
    return std::pair(-static_cast<double>(count[c.camera]),
                     promise_of(series[c.camera].cuts[c.cut].facts));
  };
  while (cuts.size() > most) {
    const auto least =
        std::min_element(cuts.begin(), cuts.end(),
                         [&](const CutOf& a, const CutOf& b) { return rank(a) < rank(b); });
    --count[least->camera];
    cuts.erase(least);
  }
}

}  // namespace

FoundCuts cut_of(const DimacsFile& problem, size_t most, const CutLimits& limits) {
  const size_t cameras = 1 + problem.more_sinks.size();
  FoundCuts found;
  std::vector<SeriesCut>& series = found.cameras;
  series.resize(cameras);
  tbb::parallel_for(size_t{0}, cameras, [&](size_t k) {
    PatchNetwork network = network_between(problem, k);
    weigh_by_light(network);
    series[k] = cameras > 1 && !problem.walks.empty()
                    ? camera_cut(network, most, limits, verify_max_flow)
                    : series_cut(network, most, limits, verify_max_flow);
  });
  CutFile& cut = found.file;
  cut.scene_hash = problem.scene_hash;
  cut.cameras = problem.cameras;
  cut.grid = problem.grid;
  cut.patches = problem.patches;
  cut.light = problem.light;
  std::vector<CutOf> cuts = cuts_of_all(series);
  keep_most_promising(cuts, series, kMostCuts);
  cut.sides.assign(cut.patches.size(), 0);
  for (const auto& [camera, c] : cuts) {
    const SeriesCut& of_camera = series[camera];
    const size_t bit = cut.cuts.size();
    for (size_t i = 0; i < cut.patches.size(); ++i)
      cut.sides[i] |= uint64_t{of_camera.region[cut.patches[i].node - 1] > c} << bit;
    const auto& [flow, facts] = of_camera.cuts[c];
    found.facts.push_back(facts);
    cut.cuts.push_back({static_cast<double>(flow) / problem.scale, facts.conductance, camera});
  }
  cut.arcs = pivot_pairs(problem, cut);
  for (const SeriesCut& s : series) cut.bottleneck |= s.bottleneck;
  if (!cut.bottleneck) cut.reason = series[0].reason;
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
  size_t arcs = 0;
  for (const FlowArc& a : problem.network.arcs)
    if (flow.source_side[a.from] && !flow.source_side[a.to])
      fmt::format_to(to, "a {} {} {}\n", a.from + 1, a.to + 1, a.capacity), ++arcs;
  fmt::format_to(to, "e {} {}\n", problem.network.nodes, arcs);
  return out;
}

}  // namespace tdpt
