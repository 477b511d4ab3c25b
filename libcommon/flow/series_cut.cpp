// Finds the openings in series that light passes, and a cut through each.
//
// Method: sweep cuts over the potential u of a resistor network (potential_sweep.h) find the drops;
// a minimum cut (max_flow.h) with the potential as data term finds the border of each.
//
// Rooms are plateaus of u. A closet beside the light's way has the potential of the room it belongs
// to, because no current passes its door, however narrow; a cut by conductance alone would choose
// that door. In the order of u, a threshold after each patch is a sweep cut; a drop is a threshold
// of small conductance: capacity across / capacity of the smaller side.
//
// Each drop is cut and judged on its own. Those accepted are cut again with the rooms between them
// as plateaus, and made nested.
#include "libcommon/flow/series_cut.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <tbb/parallel_for.h>

#include "libcommon/flow/potential_sweep.h"

namespace tdpt {

namespace {

// The sweep cut at a drop is worse than the minimum cut there: its largest conductance, of the
// largest of a bottleneck.
constexpr double kLoose = 2;
constexpr size_t kMostDrops = 12;  // that are cut, the narrowest

// A part of the sweep.
struct Part {
  size_t low = 0, high = 0;  // number of nodes before its first one and up to its last one
  bool operator==(const Part&) const = default;
};

// A place in the sweep that may separate two rooms.
struct Drop {
  size_t at;           // number of nodes before it
  double conductance;  // of the sweep cut, within the part of the sweep where it is the best
  Part part{};         // in which it is cut
};

struct Candidate {
  std::vector<uint8_t> source_side;  // per node
  int64_t flow;
  CutFacts facts;
  std::string why;  // why it is no bottleneck; empty if it is one
};

// Arc 2 v leads from the source to node v, arc 2 v + 1 from v to the sink; the arcs between patches
// follow.
FlowNetwork arcs_with_terminals(const PatchNetwork& p) {
  FlowNetwork net{p.network.nodes, p.network.source, p.network.sink, {}};
  for (uint32_t v = 0; v < net.nodes; ++v) {
    net.arcs.push_back({net.source, v, 0});
    net.arcs.push_back({v, net.sink, 0});
  }
  for (const FlowArc& a : p.network.arcs)
    if (!p.terminal(a.from) && !p.terminal(a.to)) net.arcs.push_back(a);
  return net;
}

class SeriesCutter {
 public:
  SeriesCutter(const PatchNetwork& problem, size_t most, const CutLimits& limits,
               const FlowCheck& check)
      : problem_(problem),
        net_(problem.network),
        most_(most),
        limits_(limits),
        check_(check),
        all_arcs_(arcs_with_terminals(problem)),
        graph_(all_arcs_),
        sweep_(sweep_of(problem)) {}

  SeriesCut run() {
    if (const std::string nothing = terminal_without_arcs(); !nothing.empty()) {
      deliver({judged(whole_network())}, nothing);
      return std::move(result_);
    }
    std::vector<Drop> drops = drops_to_examine();
    for (size_t c = 0; c < drops.size(); ++c)
      drops[c].part = part_around(drops, c, drops[c].conductance);
    // The minimum cut first, then each drop alone: its rooms end at other drops that are at least
    // as narrow.
    std::vector<std::optional<Candidate>> alone(1 + drops.size());
    tbb::parallel_for(size_t{0}, alone.size(), [&](size_t i) {
      if (i == 0)
        alone[0] = judged(whole_network());
      else
        alone[i] = cut_at(drops[i - 1].at, drops[i - 1].part);
    });
    const Candidate whole = std::move(*alone[0]);
    std::vector<Candidate> kept = bottlenecks_among(drops, {alone.begin() + 1, alone.end()});
    add_minimum_cut(whole, kept);
    if (kept.empty())
      deliver({whole}, reason_for(whole));
    else
      deliver(std::move(kept), "");
    return std::move(result_);
  }

 private:
  Candidate judged(const FlowNetwork& network) const {
    const MaxFlow flow = graph_.solve(network);
    if (check_) check_(network, flow);
    Candidate c{flow.source_side, flow.value, facts_of(problem_, flow.source_side), ""};
    c.why = why_refused(c.facts, limits_);
    return c;
  }

  // The problem's own network.
  FlowNetwork whole_network() const {
    FlowNetwork net = all_arcs_;
    for (const FlowArc& a : net_.arcs)
      if (a.from == net.source)
        net.arcs[2 * a.to].capacity += a.capacity;
      else if (a.to == net.sink)
        net.arcs[2 * a.from + 1].capacity += a.capacity;
    return net;
  }

  std::string terminal_without_arcs() const {
    const auto reaches_nothing = [&](uint32_t terminal) {
      return std::none_of(net_.arcs.begin(), net_.arcs.end(), [&](const FlowArc& a) {
        return a.capacity > 0 && (a.from == terminal || a.to == terminal);
      });
    };
    if (reaches_nothing(net_.source)) return "no light reaches a surface";
    if (!reaches_nothing(net_.sink)) return "";
    const std::vector<double>& viewed = problem_.viewed;
    const bool sees = std::any_of(viewed.begin(), viewed.end(), [](double n) { return n > 0; });
    return sees ? kNoLightFound : "the camera sees no surface";
  }

  // Share of the surface, of the exchanged light or of the nodes' weight, whichever is largest.
  double share(size_t low, size_t high) const {
    return sweep_.between(low, high).share_of(sweep_.before.back()).largest();
  }

  // Finds the drops between `low` and `high` (exclusive), in order: the best one, and recursively
  // those in both parts.
  void find_drops(size_t low, size_t high, std::vector<Drop>& found) const {
    Drop best{0, std::min(1.0, kLoose * limits_.largest_conductance)};
    for (size_t i = low + 1; i < high; ++i) {
      if (share(low, i) < limits_.least_area) continue;
      if (share(i, high) < limits_.least_area) break;
      // Capacities are integers: less than half of one is rounding, and a closed door is no
      // opening.
      const double conductance = sweep_.conductance(i, low, high);
      if (conductance < best.conductance && sweep_.crossing[i - 1] >= 0.5) best = {i, conductance};
    }
    if (best.at == 0) return;
    find_drops(low, best.at, found);
    found.push_back(best);
    find_drops(best.at, high, found);
  }

  // Mean potential of nodes low .. high of the sweep, weighted by area.
  double plateau(size_t low, size_t high) const {
    double sum = 0, area = 0;
    for (size_t i = low; i < high; ++i) {
      const uint32_t v = sweep_.order[i];
      sum += sweep_.u[v] * problem_.samples[v], area += problem_.samples[v];
    }
    return area > 0 ? sum / area : 0;
  }

  // The minimum cut at a drop within a part of the sweep. Empty if both sides have the same
  // potential: the door of a closet, which no light passes on its way. Data term: the distance of a
  // patch's potential from the drop, relative to that of the plateau, pulls it to its side.
  std::optional<Candidate> cut_at(size_t drop, const Part& part) const {
    const std::vector<double>& u = sweep_.u;
    const double low = plateau(part.low, drop), high = plateau(drop, part.high);
    if (high - low < limits_.least_drop) return {};
    const double at = 0.5 * (u[sweep_.order[drop - 1]] + u[sweep_.order[drop]]);
    FlowNetwork net = all_arcs_;
    for (uint32_t v = 0; v < net_.nodes; ++v) {
      if (problem_.terminal(v)) continue;
      const double whole = problem_.samples[v] * problem_.scale;
      const double pull =
          u[v] < at ? (at - u[v]) / (at - low) : (u[v] - at) / std::max(high - at, 1e-300);
      net.arcs[2 * v + (u[v] < at ? 0 : 1)].capacity = std::llround(whole * std::min(1.0, pull));
    }
    return judged(net);
  }

  // The part of the sweep around drop c, up to its neighbours among the `drops` that are no wider
  // than this.
  Part part_around(const std::vector<Drop>& drops, size_t c, double widest) const {
    Part part{0, sweep_.size()};
    for (size_t k = 0; k < drops.size(); ++k) {
      if (k == c || drops[k].conductance > widest) continue;
      (k < c ? part.low : part.high) = k < c ? drops[k].at : std::min(part.high, drops[k].at);
    }
    return part;
  }

  std::vector<Drop> drops_to_examine() {
    std::vector<Drop> drops;
    find_drops(0, sweep_.size(), drops);
    result_.passed = drops.size() - std::min(drops.size(), kMostDrops);
    result_.drops = drops.size() - result_.passed;
    while (drops.size() > kMostDrops)
      drops.erase(std::max_element(drops.begin(), drops.end(), [](const Drop& a, const Drop& b) {
        return a.conductance < b.conductance;
      }));
    return drops;
  }

  // The bottlenecks among the candidates (one per drop), at most `most_`, from the light to the
  // camera; cut again with the rooms between them.
  std::vector<Candidate> bottlenecks_among(const std::vector<Drop>& drops,
                                           const std::vector<std::optional<Candidate>>& alone) {
    std::vector<Drop> good;
    std::vector<Candidate> candidates;
    for (size_t c = 0; c < drops.size(); ++c) {
      if (!alone[c]) continue;
      if (!alone[c]->why.empty()) {
        refuse(*alone[c], alone[c]->why);
        continue;
      }
      good.push_back(drops[c]);
      candidates.push_back(*alone[c]);
    }
    keep_most(good, candidates);
    if (good.size() < 2) return candidates;
    std::vector<std::optional<Candidate>> again(good.size());
    tbb::parallel_for(size_t{0}, good.size(), [&](size_t c) {
      const Part part = part_around(good, c, INFINITY);
      if (part != good[c].part) again[c] = cut_at(good[c].at, part);
    });
    std::vector<Candidate> kept;
    for (size_t c = 0; c < good.size(); ++c)
      add(again[c] && again[c]->why.empty() ? *again[c] : candidates[c], kept);
    return kept;
  }

  void keep_most(std::vector<Drop>& drops, std::vector<Candidate>& candidates) {
    while (candidates.size() > most_) {
      const auto least = std::min_element(candidates.begin(), candidates.end(),
                                          [](const Candidate& a, const Candidate& b) {
                                            return promise_of(a.facts) < promise_of(b.facts);
                                          });
      refuse(*least, "others promise more");
      drops.erase(drops.begin() + (least - candidates.begin()));
      candidates.erase(least);
    }
  }

  // Inserts a bottleneck between the kept ones that enclose it, made nested with them. Rejects it
  // if it hardly differs from a kept one or is no longer a bottleneck.
  bool add(Candidate c, std::vector<Candidate>& kept) {
    size_t place = 0;
    for (const Candidate& k : kept) place += k.facts.side[0].area < c.facts.side[0].area;
    for (size_t i = 0; i < kept.size(); ++i)
      for (size_t v = 0; v < c.source_side.size(); ++v)
        if (i < place)
          c.source_side[v] |= kept[i].source_side[v];
        else
          c.source_side[v] &= kept[i].source_side[v];
    for (const Candidate& k : kept)
      if (difference(c, k) < limits_.least_area) return false;
    c.facts = facts_of(problem_, c.source_side);
    c.why = why_refused(c.facts, limits_);
    if (!c.why.empty()) {
      refuse(c, c.why);
      return false;
    }
    kept.insert(kept.begin() + static_cast<std::ptrdiff_t>(place), std::move(c));
    return true;
  }

  // Share of the surface, of the exchanged light or of the nodes' weight between two cuts.
  double difference(const Candidate& a, const Candidate& b) const {
    const auto differs = [&](uint32_t v) { return a.source_side[v] != b.source_side[v]; };
    SetSize part, all;
    const auto add = [&](uint32_t v, const SetSize& size) {
      all += size;
      if (differs(v)) part += size;
    };
    for (uint32_t v = 0; v < net_.nodes; ++v)
      add(v, {problem_.samples[v], 0, problem_.weight_of(v)});
    for (const FlowArc& arc : net_.arcs)
      if (!problem_.terminal(arc.from) && !problem_.terminal(arc.to))
        add(arc.from, {0, static_cast<double>(arc.capacity), 0});
    return part.share_of(all).largest();
  }

  // Adds the minimum cut of the whole network; if the only other one is the same opening, replaces
  // that.
  void add_minimum_cut(const Candidate& whole, std::vector<Candidate>& kept) {
    if (!whole.why.empty()) {
      if (kept.empty()) return;
      refuse(whole, whole.facts.smaller_side() < limits_.least_area
                        ? "the minimum cut of the network encloses no room"
                        : whole.why);
      return;
    }
    if (kept.size() == 1 && difference(whole, kept[0]) < limits_.least_area)
      kept[0] = whole;
    else if (kept.size() < most_)
      add(whole, kept);
  }

  void refuse(const Candidate& c, const std::string& why) {
    result_.refused.push_back({c.facts, why});
  }

  // If no candidate is accepted, the reason is that of the minimum cut, or of the narrowest refused
  // opening if that encloses almost nothing.
  std::string reason_for(const Candidate& whole) const {
    if (whole.facts.smaller_side() >= limits_.least_area) return whole.why;
    const SeriesCut::Refused* narrowest = nullptr;
    for (const SeriesCut::Refused& r : result_.refused)
      if (r.facts.smaller_side() >= limits_.least_area &&
          (!narrowest || r.facts.conductance < narrowest->facts.conductance))
        narrowest = &r;
    return narrowest ? narrowest->why : whole.why;
  }

  void deliver(const std::vector<Candidate>& cuts, const std::string& reason) {
    result_.reason = reason;
    result_.bottleneck = reason.empty();
    result_.region.assign(net_.nodes, 0);
    for (const Candidate& c : cuts) {
      result_.cuts.push_back({c.flow, c.facts});
      for (uint32_t v = 0; v < net_.nodes; ++v) result_.region[v] += !c.source_side[v];
    }
  }

  const PatchNetwork& problem_;
  const FlowNetwork& net_;
  size_t most_;
  const CutLimits& limits_;
  const FlowCheck& check_;
  const FlowNetwork all_arcs_;
  const FlowGraph graph_;
  const Sweep sweep_;
  SeriesCut result_;
};

}  // namespace

SeriesCut series_cut(const PatchNetwork& problem, size_t most, const CutLimits& limits,
                     const FlowCheck& check) {
  return SeriesCutter(problem, most, limits, check).run();
}

// Method: the nodes that count are numbered anew, and their regions copied back.

namespace {

constexpr uint32_t kNone = UINT32_MAX;

bool counts(const PatchNetwork& p, uint32_t v) {
  return p.terminal(v) || p.is_sky(v) || p.lit[v] > 0 || p.viewed[v] > 0;
}

// The number of each node among those that count, or kNone.
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
