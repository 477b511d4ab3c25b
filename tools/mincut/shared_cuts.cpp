#include "tools/mincut/shared_cuts.h"

#include <algorithm>
#include <utility>

namespace tdpt {
namespace {

constexpr double kSameOpening = 0.8;  // share of the light that crosses both of two cuts

SharedCut cut_of_camera(const SeriesCut& series, size_t c, uint32_t camera) {
  SharedCut cut;
  for (const uint32_t region : series.region) cut.source_side.push_back(region <= c);
  cut.flow = series.cuts[c].flow;
  cut.facts = series.cuts[c].facts;
  cut.cameras = {camera};
  return cut;
}

// Of the camera's light that crosses one of two cuts the share that crosses both without a surface
// in between; of the one with more.
double together(const PatchNetwork& p, const SharedCut& a, const SharedCut& b) {
  double both = 0, of_a = 0, of_b = 0;
  for (const FlowArc& arc : p.network.arcs) {
    if (p.terminal(arc.from) || p.terminal(arc.to)) continue;
    const bool in_a = a.source_side[arc.from] && !a.source_side[arc.to];
    const bool in_b = b.source_side[arc.from] && !b.source_side[arc.to];
    if (!in_a && !in_b) continue;
    double light = static_cast<double>(arc.capacity);
    if (!p.brightness.empty()) light *= p.brightness[arc.from] * p.importance[arc.to];
    of_a += in_a * light, of_b += in_b * light, both += (in_a && in_b) * light;
  }
  const double more = std::max(of_a, of_b);
  return more > 0 ? both / more : 0;
}

// Takes in a cut of another camera that passes the same opening.
void join(SharedCut& cut, SharedCut other) {
  other.cameras.insert(other.cameras.begin(), cut.cameras.begin(), cut.cameras.end());
  if (other.facts.conductance < cut.facts.conductance)
    cut = std::move(other);
  else
    cut.cameras = std::move(other.cameras);
}

}  // namespace

std::vector<SharedCut> shared_cuts(const std::vector<PatchNetwork>& networks,
                                   const std::vector<SeriesCut>& series) {
  std::vector<SharedCut> shared;
  for (uint32_t k = 0; k < series.size(); ++k) {
    if (!series[k].bottleneck) continue;
    for (size_t c = 0; c < series[k].cuts.size(); ++c) {
      SharedCut cut = cut_of_camera(series[k], c, k);
      const auto is_same = [&](const SharedCut& other) {
        return other.cameras.back() < k &&  // cuts of one camera are different openings
               std::min(together(networks[k], cut, other),
                        together(networks[other.cameras.back()], cut, other)) >= kSameOpening;
      };
      const auto same = std::find_if(shared.begin(), shared.end(), is_same);
      if (same == shared.end())
        shared.push_back(std::move(cut));
      else
        join(*same, std::move(cut));
    }
  }
  if (shared.empty()) shared.push_back(cut_of_camera(series[0], 0, 0));
  return shared;
}

void keep_most_promising(std::vector<SharedCut>& cuts, size_t most) {
  while (cuts.size() > most)
    cuts.erase(
        std::min_element(cuts.begin(), cuts.end(), [](const SharedCut& a, const SharedCut& b) {
          return std::pair(a.cameras.size(), promise_of(a.facts)) <
                 std::pair(b.cameras.size(), promise_of(b.facts));
        }));
}

}  // namespace tdpt
