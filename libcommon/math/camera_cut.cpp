// Method: the nodes that count are numbered anew, and their regions copied back.
#include "libcommon/math/camera_cut.h"

#include <algorithm>
#include <utility>

namespace tdpt {
namespace {

constexpr uint32_t kNone = UINT32_MAX;

bool counts(const PatchNetwork& p, uint32_t v) {
  return p.terminal(v) || p.is_sky(v) || p.lit[v] > 0 || p.viewed[v] > 0;
}

// Of each node its number among those that count, or kNone.
std::vector<uint32_t> numbers_of(const PatchNetwork& p) {
  std::vector<uint32_t> numbers(p.network.nodes, kNone);
  uint32_t next = 0;
  for (uint32_t v = 0; v < p.network.nodes; ++v)
    if (counts(p, v)) numbers[v] = next++;
  return numbers;
}

PatchNetwork part_of(const PatchNetwork& whole, const std::vector<uint32_t>& numbers) {
  const auto chosen = [&]<class T>(const std::vector<T>& all) {
    std::vector<T> some;
    for (size_t v = 0; v < all.size(); ++v)
      if (numbers[v] != kNone) some.push_back(all[v]);
    return some;
  };
  PatchNetwork part{{}, chosen(whole.samples), whole.scale};
  part.begun = chosen(whole.begun), part.lit = chosen(whole.lit);
  part.viewed = chosen(whole.viewed), part.weight = chosen(whole.weight);
  part.sky = chosen(whole.sky);
  part.brightness = chosen(whole.brightness), part.importance = chosen(whole.importance);
  const FlowNetwork& net = whole.network;
  part.network = {
      static_cast<uint32_t>(part.samples.size()), numbers[net.source], numbers[net.sink], {}};
  for (const FlowArc& a : net.arcs)
    if (numbers[a.from] != kNone && numbers[a.to] != kNone)
      part.network.arcs.push_back({numbers[a.from], numbers[a.to], a.capacity});
  return part;
}

// Per node of the whole network.
std::vector<uint32_t> regions_of(const PatchNetwork& whole, const std::vector<uint32_t>& numbers,
                                 const SeriesCut& found) {
  const size_t regions = found.cuts.size() + 1;
  std::vector<uint32_t> region(whole.network.nodes, 0);
  std::vector<int64_t> towards(regions * whole.network.nodes, 0);
  for (const FlowArc& a : whole.network.arcs)
    if (numbers[a.from] == kNone && numbers[a.to] != kNone)
      towards[regions * a.from + found.region[numbers[a.to]]] += a.capacity;
  for (uint32_t v = 0; v < whole.network.nodes; ++v) {
    const auto own = towards.begin() + static_cast<std::ptrdiff_t>(regions * v);
    region[v] = numbers[v] != kNone
                    ? found.region[numbers[v]]
                    : static_cast<uint32_t>(
                          std::max_element(own, own + static_cast<std::ptrdiff_t>(regions)) - own);
  }
  return region;
}

}  // namespace

SeriesCut camera_cut(const PatchNetwork& whole, size_t most, const CutLimits& limits,
                     const FlowCheck& check) {
  const std::vector<uint32_t> numbers = numbers_of(whole);
  SeriesCut found = series_cut(part_of(whole, numbers), most, limits, check);
  found.region = regions_of(whole, numbers, found);
  return found;
}

}  // namespace tdpt
