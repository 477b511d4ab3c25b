#include "libcommon/flow/cut_facts.h"

#include <fmt/format.h>

#include "libcommon/base/words.h"

namespace tdpt {
CutFacts facts_of(const PatchNetwork& p, const std::vector<uint8_t>& source_side) {
  CutFacts f;
  const FlowNetwork& net = p.network;
  const auto side = [&](uint32_t v) { return source_side[v] ? size_t{0} : size_t{1}; };
  double carried[2] = {0, 0}, straight = 0, scattered = 0, lamps = 0;
  for (uint32_t v = 0; v < net.nodes; ++v) {
    if (!p.begun.empty() && side(v) == 0 && !p.is_sky(v)) lamps += p.begun[v];
    if (!p.terminal(v)) f.side[side(v)] += {p.samples[v], 0, p.weight_of(v)};
  }
  for (const FlowArc& a : net.arcs) {
    if (p.terminal(a.from) || p.terminal(a.to) || a.from == a.to) continue;
    const double capacity = static_cast<double>(a.capacity);
    f.side[side(a.from)].volume += capacity;
    if (side(a.from) == side(a.to)) continue;
    if (side(a.from) == 0) f.crossing += capacity;
    if (side(a.from) == 0 && !p.begun.empty() && p.samples[a.from] > 0) {
      const double chance = capacity / (p.scale * p.samples[a.from]);
      (p.is_sky(a.from) ? scattered : straight) += chance * p.begun[a.from];
      scattered += chance * p.lit[a.from];
    }
    if (!p.brightness.empty())
      carried[side(a.from)] += capacity / p.scale * p.brightness[a.from] * p.importance[a.to];
  }
  if (!p.brightness.empty()) f.carried = carried[0], f.carried_back = carried[1];
  if (straight + scattered > 0) f.straight = straight / (straight + scattered);
  if (lamps > 0) f.seen = std::min(1.0, straight / lamps);
  const double smaller = std::min(f.side[0].volume, f.side[1].volume);
  if (smaller > 0) f.conductance = f.crossing / smaller;
  SetSize all = f.side[0];
  all += f.side[1];
  for (SetSize& size : f.side) size = size.share_of(all);
  return f;
}

std::string why_refused(const CutFacts& f, const CutLimits& limits) {
  const bool small = f.smaller_side() < limits.least_area;
  if (f.crossing <= 0 && !small) return kNoLightFound;
  if (f.straight.value_or(0) >= limits.straight && f.seen.value_or(0) >= limits.seen)
    return fmt::format(
        "the lamp stands in its own opening: {} of the light that crosses the cut comes straight "
        "from it, and sampling the lamp finds the opening as a portal would",
        percent_words(*f.straight));
  if (small) {
    const size_t s = f.side[0].largest() < f.side[1].largest() ? 0 : 1;
    return fmt::format(
        "the {} side of the cut has {:.1f} % of the surface and {:.1f} % of the exchanged light, "
        "less than {:.1f} %: light and camera share one open space",
        s == 0 ? "light's" : "camera's", 100 * f.side[s].area, 100 * f.side[s].volume,
        100 * limits.least_area);
  }
  if (f.carried && *f.carried < limits.least_carried)
    return fmt::format("by the network only {} of the light crosses the cut",
                       percent_words(*f.carried));
  if (f.conductance > limits.largest_conductance)
    return fmt::format(
        "{} of the smaller side's light crosses the cut, more than {}: the opening is wide",
        number_words(f.conductance, 2), number_words(limits.largest_conductance, 2));
  return "";
}

double promise_of(const CutFacts& f) {
  return f.carried.value_or(1) / std::max(f.conductance, 1e-9);
}

}  // namespace tdpt
