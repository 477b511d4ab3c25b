#include "libcommon/math/series_cut.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace tdpt {
namespace {

constexpr uint32_t kOutside = UINT32_MAX;

// Nodes of a part of the network, and how strongly each end reaches them.
struct Part {
  std::vector<uint32_t> nodes;
  std::vector<int64_t> from_source, to_sink;  // capacities of the terminals' arcs, node by node
};

class SeriesCutter {
 public:
  SeriesCutter(const PatchNetwork& problem, size_t most, const CutLimits& limits,
               const FlowSolver& solve)
      : problem_(problem), left_(most), limits_(limits), solve_(solve) {
    for (const double n : problem.samples) area_ += n;
  }

  SeriesCut run() {
    const FlowNetwork& net = problem_.network;
    Part whole;
    std::vector<uint32_t> index(net.nodes, kOutside);
    for (uint32_t v = 0; v < net.nodes; ++v) {
      if (v == net.source || v == net.sink) continue;
      index[v] = static_cast<uint32_t>(whole.nodes.size());
      whole.nodes.push_back(v);
    }
    whole.from_source.assign(whole.nodes.size(), 0);
    whole.to_sink.assign(whole.nodes.size(), 0);
    for (const FlowArc& a : net.arcs) {
      if (a.from == net.source && index[a.to] != kOutside)
        whole.from_source[index[a.to]] += a.capacity;
      if (a.to == net.sink && index[a.from] != kOutside) whole.to_sink[index[a.from]] += a.capacity;
    }
    result_.region.assign(net.nodes, 0);
    cut(whole);
    result_.region[net.sink] = static_cast<uint32_t>(result_.cuts.size());
    if (!result_.bottleneck) return std::move(result_);
    for (size_t c = 0; c < result_.cuts.size(); ++c) result_.cuts[c].conductance = conductance(c);
    return std::move(result_);
  }

 private:
  struct Sides {
    double area[2] = {0, 0};    // in samples
    double volume[2] = {0, 0};  // capacity of the arcs that leave a node of this side for another
    double crossing = 0;        // from the source's side to the sink's
    double conductance() const {
      const double smaller = std::min(volume[0], volume[1]);
      return smaller > 0 ? crossing / smaller : 1;
    }
  };

  // The part as a network of its own: node 0 is its source, 1 its sink.
  FlowNetwork network_of(const Part& part, std::vector<uint32_t>& index) const {
    index.assign(problem_.network.nodes, kOutside);
    FlowNetwork net{static_cast<uint32_t>(part.nodes.size()) + 2, 0, 1, {}};
    for (uint32_t i = 0; i < part.nodes.size(); ++i) {
      index[part.nodes[i]] = i;
      if (part.from_source[i] > 0) net.arcs.push_back({0, i + 2, part.from_source[i]});
      if (part.to_sink[i] > 0) net.arcs.push_back({i + 2, 1, part.to_sink[i]});
    }
    for (const FlowArc& a : problem_.network.arcs)
      if (index[a.from] != kOutside && index[a.to] != kOutside)
        net.arcs.push_back({index[a.from] + 2, index[a.to] + 2, a.capacity});
    return net;
  }

  Sides sides_of(const Part& part, const FlowNetwork& net, const MaxFlow& flow) const {
    Sides s;
    for (uint32_t i = 0; i < part.nodes.size(); ++i)
      s.area[flow.source_side[i + 2] ? 0 : 1] += problem_.samples[part.nodes[i]];
    for (const FlowArc& a : net.arcs) {
      if (a.from < 2 || a.to < 2 || a.from == a.to) continue;
      const double capacity = static_cast<double>(a.capacity);
      s.volume[flow.source_side[a.from] ? 0 : 1] += capacity;
      if (flow.source_side[a.from] && !flow.source_side[a.to]) s.crossing += capacity;
    }
    return s;
  }

  std::string why_no_bottleneck(const Sides& s) const {
    const int small = s.area[0] < s.area[1] ? 0 : 1;
    if (s.area[small] < limits_.least_area * area_)
      return fmt::format(
          "the {} side of the cut has {:.1f} % of the surface, less than {:.1f} %: light and "
          "camera share one open space",
          small == 0 ? "light's" : "camera's", 100 * s.area[small] / area_,
          100 * limits_.least_area);
    if (s.crossing <= 0) return "no light passes from the light's side of the cut to the camera's";
    if (s.conductance() > limits_.largest_conductance)
      return fmt::format(
          "{:.2g} of the smaller side's light crosses the cut, more than {:.2g}: the opening is "
          "wide",
          s.conductance(), limits_.largest_conductance);
    return "";
  }

  // Cuts a part and what lies on either side, from the light to the camera. Its nodes leave with
  // their regions.
  void cut(const Part& part) {
    const auto first = static_cast<uint32_t>(result_.cuts.size());
    const auto in_one_region = [&](uint32_t region) {
      for (const uint32_t v : part.nodes) result_.region[v] = region;
    };
    if (left_ == 0) return in_one_region(first);
    std::vector<uint32_t> index;
    const FlowNetwork net = network_of(part, index);
    const MaxFlow flow = solve_(net);
    const Sides sides = sides_of(part, net, flow);
    const std::string reason = why_no_bottleneck(sides);
    if (!reason.empty() && result_.cuts.empty() && !result_.bottleneck) {
      // Nothing was found at all: the cut is kept for those who want to look at it.
      result_.reason = reason;
      result_.cuts.push_back({flow.value, sides.conductance()});
      for (uint32_t i = 0; i < part.nodes.size(); ++i)
        result_.region[part.nodes[i]] = flow.source_side[i + 2] ? 0 : 1;
      return;
    }
    if (!reason.empty()) return in_one_region(first);
    result_.bottleneck = true;
    --left_;

    Part side[2];
    for (uint32_t i = 0; i < part.nodes.size(); ++i) {
      Part& s = side[flow.source_side[i + 2] ? 0 : 1];
      s.nodes.push_back(part.nodes[i]);
      s.from_source.push_back(part.from_source[i]);
      s.to_sink.push_back(part.to_sink[i]);
    }
    for (int k = 0; k < 2; ++k) {
      const std::vector<int64_t> door = grade_opening(side[k], net, flow, index, k == 0);
      (k == 0 ? side[k].to_sink : side[k].from_source) = door;
    }
    cut(side[0]);
    result_.cuts.push_back({flow.value, 0});
    cut(side[1]);
  }

  // Capacities of arcs that join the nodes of one side of a cut to its opening: the etendue of each
  // node, graded by how much of a diffusion that enters through the opening it receives.
  std::vector<int64_t> grade_opening(const Part& side, const FlowNetwork& net, const MaxFlow& flow,
                                     const std::vector<uint32_t>& index, bool source_side) const {
    const size_t n = side.nodes.size();
    std::vector<uint32_t> here(net.nodes, kOutside);
    for (uint32_t i = 0; i < n; ++i) here[index[side.nodes[i]] + 2] = i;
    struct Step {
      uint32_t from, to;
      double capacity;
    };
    std::vector<Step> steps;
    std::vector<double> leaving(n, 0), density(n, 0);
    for (const FlowArc& a : net.arcs) {
      if (a.from < 2 || a.to < 2) continue;
      const double capacity = static_cast<double>(a.capacity);
      const bool from_here = (flow.source_side[a.from] != 0) == source_side;
      const bool to_here = (flow.source_side[a.to] != 0) == source_side;
      if (from_here) leaving[here[a.from]] += capacity;
      if (from_here && to_here) steps.push_back({here[a.from], here[a.to], capacity});
      if (!from_here && to_here) density[here[a.to]] += capacity;
    }
    std::vector<double> hits(n, 0), next(n);
    for (int step = 0; step < kDiffusionSteps; ++step) {
      for (size_t i = 0; i < n; ++i) hits[i] += density[i];
      std::fill(next.begin(), next.end(), 0);
      for (const Step& s : steps) next[s.to] += density[s.from] * s.capacity / leaving[s.from];
      std::swap(density, next);
    }
    std::vector<double> samples;
    for (const uint32_t v : side.nodes) samples.push_back(problem_.samples[v]);
    const std::vector<double> grade = terminal_grades(hits, samples);
    std::vector<int64_t> capacity(n);
    for (size_t i = 0; i < n; ++i)
      capacity[i] = std::llround(samples[i] * grade[i] * problem_.scale);
    return capacity;
  }

  // Of cut c in the whole network.
  double conductance(size_t c) const {
    Sides s;
    const FlowNetwork& net = problem_.network;
    const auto terminal = [&](uint32_t v) { return v == net.source || v == net.sink; };
    for (const FlowArc& a : net.arcs) {
      if (terminal(a.from) || terminal(a.to) || a.from == a.to) continue;
      const double capacity = static_cast<double>(a.capacity);
      const bool from = result_.region[a.from] <= c, to = result_.region[a.to] <= c;
      s.volume[from ? 0 : 1] += capacity;
      if (from && !to) s.crossing += capacity;
    }
    return s.conductance();
  }

  const PatchNetwork& problem_;
  size_t left_;
  const CutLimits& limits_;
  const FlowSolver& solve_;
  double area_ = 0;
  SeriesCut result_;
};

}  // namespace

SeriesCut series_cut(const PatchNetwork& problem, size_t most, const CutLimits& limits,
                     const FlowSolver& solve) {
  return SeriesCutter(problem, most, limits, solve).run();
}

std::vector<double> terminal_grades(const std::vector<double>& hits,
                                    const std::vector<double>& samples) {
  std::vector<double> grade(hits.size(), 0);
  std::vector<uint32_t> order;
  double total = 0;
  for (uint32_t i = 0; i < hits.size(); ++i) {
    if (samples[i] <= 0 || hits[i] <= 0) continue;
    grade[i] = hits[i] / samples[i];
    total += hits[i];
    order.push_back(i);
  }
  if (order.empty()) return grade;
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return grade[a] != grade[b] ? grade[a] < grade[b] : a < b;
  });
  double below = 0, median = 0;
  for (uint32_t i : order) {
    below += hits[i];
    median = grade[i];
    if (below >= 0.5 * total) break;
  }
  for (uint32_t i : order) grade[i] = std::min(1.0, grade[i] / (0.5 * median));
  return grade;
}

}  // namespace tdpt
