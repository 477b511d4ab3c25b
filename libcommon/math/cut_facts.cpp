#include "libcommon/math/cut_facts.h"

#include <algorithm>

#include <fmt/format.h>

#include "libcommon/base/number_words.h"

namespace tdpt {
namespace {

// Shares from which a lamp is said to be in its own opening: light that crosses straight from lamps
// / all that crosses, and the same / all that the lamps emit. Then light sampling finds the opening
// as well as a portal would. A window niche needs smaller shares than a room with a lamp near the
// opening, whose walls scatter light through it.
struct Own {
  double straight, seen;
};
constexpr Own kOfNiche{0.2, 0.1}, kOfRoom{0.24, 0.12};
// Factor on the largest conductance.
constexpr double kStillOpening = 1.5;
// Factor likewise, for the opening of a room: through a narrower one most light is scattered first,
// wherever the lamp.
constexpr double kHardlyNarrow = 0.4;
constexpr double kNiche = 0.2;  // smaller share on the light's side: the niche of a window
// From this share on, the lamps of a niche send nearly all their light across: there is no opening.
constexpr double kOpen = 0.9;
constexpr double kMostBack = 0.9;   // share of the walks that cross
constexpr double kFewestBack = 10;  // crossing walks: of fewer, a random number comes back
constexpr double kMostSkyBeyond = 0.1;
constexpr double kOpenToSky = 0.2;      // share of what crosses that comes from the sky itself
constexpr double kLeastCarried = 0.01;  // of the camera's light
constexpr double kLeastAcross = 0.005;  // share of the light on the camera's side

std::string percent(double share) {
  return percent_words(share);
}

}  // namespace

CutFacts facts_of(const PatchNetwork& p, const std::vector<uint8_t>& source_side) {
  CutFacts f;
  const FlowNetwork& net = p.network;
  const auto side = [&](uint32_t v) { return source_side[v] ? size_t{0} : size_t{1}; };
  const bool walks = !p.begun.empty();
  double carried[2] = {0, 0};
  double straight = 0, sky = 0, scattered = 0, back = 0, total_area = 0;
  double camera[2] = {0, 0};  // from T, from S
  for (uint32_t v = 0; v < net.nodes; ++v)
    if (!p.terminal(v)) f.area[side(v)] += p.samples[v], total_area += p.samples[v];
  double sky_fed[2] = {0, 0};
  for (const FlowArc& a : net.arcs) {
    if (a.from == net.source && p.is_sky(a.to))
      sky_fed[side(a.to)] += static_cast<double>(a.capacity);
    if (p.terminal(a.from) || p.terminal(a.to) || a.from == a.to) continue;
    const double capacity = static_cast<double>(a.capacity);
    f.volume[side(a.from)] += capacity;
    if (side(a.from) == side(a.to)) continue;
    const bool forward = side(a.from) == 0;
    if (forward) f.crossing += capacity;
    if (forward && p.is_sky(a.from)) f.sky_across += capacity;
    if (!p.brightness.empty())
      carried[side(a.from)] += capacity / p.scale * p.brightness[a.from] * p.importance[a.to];
    if (!walks || p.samples[a.from] <= 0) continue;
    const double chance = capacity / (p.scale * p.samples[a.from]);
    camera[forward] += chance * p.viewed[a.from];
    if (!forward) {
      back += chance * (p.begun[a.from] + p.lit[a.from]);
      continue;
    }
    (p.is_sky(a.from) ? sky : straight) += chance * p.begun[a.from];
    scattered += chance * p.lit[a.from];
  }
  if (!p.brightness.empty()) f.carried = carried[0], f.carried_back = carried[1];
  if (f.crossing > 0) f.sky_across /= f.crossing;
  if (sky_fed[1] > 0) f.sky_beyond = sky_fed[1] / (sky_fed[0] + sky_fed[1]);
  const double smaller = std::min(f.volume[0], f.volume[1]);
  if (smaller > 0) f.conductance = f.crossing / smaller;
  const double total_volume = f.volume[0] + f.volume[1];
  for (const size_t s : {0, 1}) {
    if (total_area > 0) f.area[s] /= total_area;
    if (total_volume > 0) f.volume[s] /= total_volume;
  }
  if (!walks) return f;
  double begun[2] = {0, 0}, lamps = 0, viewed = 0;
  for (uint32_t v = 0; v < net.nodes; ++v) {
    if (p.terminal(v)) continue;
    begun[side(v)] += p.begun[v];
    if (side(v) == 0 && !p.is_sky(v)) lamps += p.begun[v];
    if (!p.sky.empty()) f.viewed[side(v)] += p.viewed[v], viewed += p.viewed[v];
  }
  if (viewed > 0)
    for (double& share : f.viewed) share /= viewed;
  const double crosses = straight + sky + scattered;
  if (crosses > 0) {
    f.across = crosses / (crosses + begun[1]);
    f.straight = straight / crosses;
    // All light that enters from the open leaves again.
    if (p.sky.empty() && crosses >= kFewestBack) f.back = back / crosses;
    if (camera[0] >= kFewestBack) f.camera_back = camera[1] / camera[0];
  }
  if (lamps > 0) f.seen = std::min(1.0, straight / lamps);
  return f;
}

bool still_opening(const CutFacts& f, const CutLimits& limits) {
  return f.smaller_side() >= limits.least_area &&
         f.conductance <= kStillOpening * limits.largest_conductance;
}

bool lamp_in_its_opening(const CutFacts& f, const CutLimits& limits) {
  const double seen = f.seen.value_or(0);
  const bool niche = f.side(0) < kNiche && seen < kOpen;
  const Own least = niche ? kOfNiche : kOfRoom;
  const bool wide =
      still_opening(f, limits) && f.conductance >= kHardlyNarrow * limits.largest_conductance;
  return (niche || wide) && f.straight.value_or(0) >= least.straight && seen >= least.seen;
}

std::string why_refused(const CutFacts& f, const CutLimits& limits) {
  const bool small = f.smaller_side() < limits.least_area;
  if (f.crossing <= 0 && !small)
    return "no light was seen to pass from the light's side of the cut to the camera's; it may "
           "pass "
           "where no walk passed, through a keyhole: more walks look closer";
  if (lamp_in_its_opening(f, limits))
    return fmt::format(
        "the lamp stands in its own opening: {} of the light that crosses the cut comes straight "
        "from it, and sampling the lamp finds the opening as a portal would",
        percent(*f.straight));
  if (small) {
    const size_t s = f.side(0) < f.side(1) ? 0 : 1;
    return fmt::format(
        "the {} side of the cut has {:.1f} % of the surface and {:.1f} % of the exchanged light, "
        "less than {:.1f} %: light and camera share one open space",
        s == 0 ? "light's" : "camera's", 100 * f.area[s], 100 * f.volume[s],
        100 * limits.least_area);
  }
  if (f.sky_beyond > kMostSkyBeyond)
    return fmt::format("{} of the sky lies on the camera's side of the cut, which parts the open",
                       percent(f.sky_beyond));
  if (f.back.value_or(0) > kMostBack)
    return fmt::format(
        "as much light comes back across the cut as crosses it ({} times): the lamps shine "
        "past "
        "its light's side",
        number_words(*f.back, 2));
  if (f.camera_back.value_or(0) > kMostBack)
    return "the camera sees past the cut: its walks cross it as often away from the light as "
           "towards "
           "it";
  if (f.carried && *f.carried < kLeastCarried)
    return fmt::format("only {} of the light that the camera sees crosses the cut",
                       percent(*f.carried));
  if (f.across && *f.across < kLeastAcross)
    return fmt::format(
        "of the light on the camera's side of the cut only {} comes across it: the rest is that of "
        "lamps on that side",
        percent(*f.across));
  if (f.conductance > limits.largest_conductance && f.sky_across >= kOpenToSky)
    return fmt::format(
        "the room stands open to the sky: {} of its light crosses the opening, more than "
        "{}, so that the sky is found without a portal",
        number_words(f.conductance, 2), number_words(limits.largest_conductance, 2));
  if (f.conductance > limits.largest_conductance)
    return fmt::format(
        "{} of the smaller side's light crosses the cut, more than {}: the opening is wide",
        number_words(f.conductance, 2), number_words(limits.largest_conductance, 2));
  return "";
}

std::string words_for(const CutFacts& f) {
  return fmt::format(
      "{} of the surface lies on the light's side{}; {} of the smaller side's light crosses "
      "the "
      "cut",
      percent(f.area[0]),
      f.straight
          ? fmt::format(", {} of what crosses comes straight from a lamp", percent(*f.straight))
          : "",
      number_words(f.conductance, 2));
}

double promise_of(const CutFacts& f) {
  return f.across.value_or(1) * (1 - f.straight.value_or(0)) / std::max(f.conductance, 1e-9);
}

}  // namespace tdpt
