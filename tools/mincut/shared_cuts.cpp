#include "tools/mincut/shared_cuts.h"

#include <algorithm>
#include <utility>

namespace tdpt {
namespace {

SharedCut cut_of_camera(const SeriesCut& series, size_t c, uint32_t camera) {
  SharedCut cut;
  for (const uint32_t region : series.region) cut.source_side.push_back(region <= c);
  cut.flow = series.cuts[c].flow;
  cut.facts = series.cuts[c].facts;
  cut.cameras = {camera};
  return cut;
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
                                   const std::vector<SeriesCut>& series, const CutLimits& limits) {
  std::vector<SharedCut> shared;
  for (uint32_t k = 0; k < series.size(); ++k) {
    if (!series[k].bottleneck) continue;
    for (size_t c = 0; c < series[k].cuts.size(); ++c) {
      SharedCut cut = cut_of_camera(series[k], c, k);
      const auto is_same = [&](const SharedCut& other) {
        return other.cameras.back() < k &&  // cuts of one camera are different openings
               std::min(shared_light(networks[k], cut.source_side, other.source_side),
                        shared_light(networks[other.cameras.back()], cut.source_side,
                                     other.source_side)) >= limits.same_opening;
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
