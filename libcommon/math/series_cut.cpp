// The openings that the light passes one behind the other, and the cut through each.
//
// Method: a network of resistors, as in random-walker segmentation (Grady 2006), solved by
// conjugate gradients; sweep cuts over its potential find the drops; a minimum cut (max_flow.h)
// with the potential as data term draws the border of each.
//
// u_i       potential of patch i, 0 where the light reaches it well, 1 where the camera does: the
//           chance that a random walk from i along the arcs comes to the camera's patches first
// c_ij      half the capacity of the arcs between i and j, either way
// s_i, t_i  what holds u_i at 0 and at 1
//   sum_j c_ij (u_i - u_j) + s_i u_i + t_i (u_i - 1) = 0
//
// Rooms are plateaus of u. A closet beside the light's way has the potential of the room it belongs
// to: no current passes its door, however narrow, which a cut by conductance alone would take. In
// the order of u a threshold behind each patch parts the others; a drop is a threshold of small
// conductance in the graph's sense: capacity across over that of the smaller side.
#include "libcommon/math/series_cut.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace tdpt {
namespace {

constexpr double kPinned = 0.5;      // grade from which a terminal holds a patch's potential
constexpr double kLeastDrop = 0.01;  // of u between two rooms
constexpr int kMostIterations = 2000;
constexpr double kResidual = 1e-9;  // of the conjugate gradients, relative

// The resistors: conductances c_ij of the patches' links in rows, and the terminals' arcs.
struct Links {
  struct Link {
    uint32_t to;
    double capacity;
  };
  std::vector<size_t> first;  // links of node v: first[v] .. first[v + 1]
  std::vector<Link> links;
  std::vector<double> total;                 // of each node's links
  std::vector<double> from_source, to_sink;  // of each node
};

Links links_of(const PatchNetwork& p) {
  const FlowNetwork& net = p.network;
  Links l;
  l.first.assign(net.nodes + 1, 0);
  l.total.assign(net.nodes, 0);
  l.from_source.assign(net.nodes, 0);
  l.to_sink.assign(net.nodes, 0);
  const auto inner = [&](const FlowArc& a) {
    return a.from != net.source && a.to != net.sink && a.from != net.sink && a.to != net.source &&
           a.from != a.to && a.capacity > 0;
  };
  for (const FlowArc& a : net.arcs) {
    if (a.from == net.source) l.from_source[a.to] += static_cast<double>(a.capacity);
    if (a.to == net.sink) l.to_sink[a.from] += static_cast<double>(a.capacity);
    if (inner(a)) ++l.first[a.from + 1], ++l.first[a.to + 1];
  }
  std::partial_sum(l.first.begin(), l.first.end(), l.first.begin());
  l.links.resize(l.first.back());
  std::vector<size_t> next(l.first.begin(), l.first.end() - 1);
  for (const FlowArc& a : net.arcs) {
    if (!inner(a)) continue;
    // Either direction carries half of what joins the two.
    const double half = 0.5 * static_cast<double>(a.capacity);
    l.links[next[a.from]++] = {a.to, half};
    l.links[next[a.to]++] = {a.from, half};
    l.total[a.from] += half;
    l.total[a.to] += half;
  }
  return l;
}

// u of each node, by conjugate gradients with the diagonal as preconditioner; s and t hold the
// patches that light and camera reach well.
std::vector<double> potential_of(const PatchNetwork& p, const Links& l) {
  const uint32_t n = p.network.nodes;
  std::vector<double> diagonal(n), right(n, 0), u(n, 0.5);
  for (uint32_t v = 0; v < n; ++v) {
    const double whole = p.samples[v] * p.scale;
    const double s = l.from_source[v], t = l.to_sink[v];
    const double hold = std::max(s, t) >= kPinned * whole ? std::abs(s - t) : 0;
    // Patches that nothing holds and nothing joins stay at 1/2.
    const double loose = 1e-9 * whole + 1e-30;
    diagonal[v] = l.total[v] + hold + loose;
    right[v] = (t > s ? hold : 0) + 0.5 * loose;
  }
  const auto apply = [&](const std::vector<double>& x, std::vector<double>& y) {
    for (uint32_t v = 0; v < n; ++v) {
      double sum = diagonal[v] * x[v];
      for (size_t k = l.first[v]; k < l.first[v + 1]; ++k)
        sum -= l.links[k].capacity * x[l.links[k].to];
      y[v] = sum;
    }
  };
  const auto product = [](const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  };
  std::vector<double> r(n), z(n), d(n), q(n);
  apply(u, q);
  for (uint32_t v = 0; v < n; ++v) r[v] = right[v] - q[v], z[v] = r[v] / diagonal[v];
  d = z;
  double rz = product(r, z);
  const double enough = kResidual * kResidual * rz;
  for (int i = 0; i < kMostIterations && rz > enough; ++i) {
    apply(d, q);
    const double step = rz / product(d, q);
    for (uint32_t v = 0; v < n; ++v) {
      u[v] += step * d[v], r[v] -= step * q[v];
      z[v] = r[v] / diagonal[v];
    }
    const double next = product(r, z);
    for (uint32_t v = 0; v < n; ++v) d[v] = z[v] + next / rz * d[v];
    rz = next;
  }
  return u;
}

struct Sides {
  double area[2] = {0, 0};    // in samples
  double volume[2] = {0, 0};  // capacity of the arcs that leave a node of this side for another
  double crossing = 0;        // from the source's side to the sink's
  double conductance() const {
    const double smaller = std::min(volume[0], volume[1]);
    return smaller > 0 ? crossing / smaller : 1;
  }
};

class SeriesCutter {
 public:
  SeriesCutter(const PatchNetwork& problem, size_t most, const CutLimits& limits,
               const FlowSolver& solve)
      : problem_(problem), net_(problem.network), most_(most), limits_(limits), solve_(solve) {
    for (const double n : problem.samples) area_ += n;
  }

  SeriesCut run() {
    result_.region.assign(net_.nodes, 0);
    const Links links = links_of(problem_);
    const std::vector<double> u = potential_of(problem_, links);
    const Sweep s = sweep(links, u);
    std::vector<size_t> found;
    drops(s, 0, s.order.size(), found);
    keep_real_drops(s, u, found);
    // One opening, or none: the minimum cut itself, if it parts two rooms.
    if (found.size() < 2 && minimum_cut()) return std::move(result_);
    if (!found.empty() && !cuts_at(s, u, found)) minimum_cut();
    return std::move(result_);
  }

 private:
  bool terminal(uint32_t v) const { return v == net_.source || v == net_.sink; }

  // Of the regions up to c and those above.
  Sides sides_of(size_t c) const {
    Sides s;
    const auto side = [&](uint32_t v) { return result_.region[v] <= c ? 0 : 1; };
    for (uint32_t v = 0; v < net_.nodes; ++v)
      if (!terminal(v)) s.area[side(v)] += problem_.samples[v];
    for (const FlowArc& a : net_.arcs) {
      if (terminal(a.from) || terminal(a.to) || a.from == a.to) continue;
      const double capacity = static_cast<double>(a.capacity);
      s.volume[side(a.from)] += capacity;
      if (side(a.from) < side(a.to)) s.crossing += capacity;
    }
    return s;
  }

  std::string why_no_bottleneck(const MaxFlow& flow, const Sides& s) const {
    const auto reaches_nothing = [&](uint32_t terminal) {
      return std::none_of(net_.arcs.begin(), net_.arcs.end(), [&](const FlowArc& a) {
        return a.capacity > 0 && (a.from == terminal || a.to == terminal);
      });
    };
    if (flow.value == 0 && reaches_nothing(net_.source)) return "no light reaches a surface";
    if (flow.value == 0 && reaches_nothing(net_.sink)) return "the camera sees no surface";
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

  // Nodes in the order of their potential, and the sweep cut behind each of them.
  struct Sweep {
    std::vector<uint32_t> order;
    std::vector<double> area, volume;  // up to and with this node
    std::vector<double> crossing;      // capacity between it and those before, and those behind
  };

  Sweep sweep(const Links& links, const std::vector<double>& u) const {
    Sweep s;
    for (uint32_t v = 0; v < net_.nodes; ++v)
      if (!terminal(v)) s.order.push_back(v);
    std::sort(s.order.begin(), s.order.end(),
              [&](uint32_t a, uint32_t b) { return u[a] != u[b] ? u[a] < u[b] : a < b; });
    std::vector<uint8_t> before(net_.nodes, 0);
    double area = 0, volume = 0, crossing = 0;
    for (const uint32_t v : s.order) {
      before[v] = 1;
      area += problem_.samples[v];
      volume += links.total[v];
      for (size_t k = links.first[v]; k < links.first[v + 1]; ++k)
        crossing += before[links.links[k].to] ? -links.links[k].capacity : links.links[k].capacity;
      s.area.push_back(area);
      s.volume.push_back(volume);
      s.crossing.push_back(crossing);
    }
    return s;
  }

  // Places in the sweep between `low` and `high` (exclusive) where it parts two rooms, in order:
  // the best one, and those within both parts.
  void drops(const Sweep& s, size_t low, size_t high, std::vector<size_t>& found) const {
    const auto up_to = [](const std::vector<double>& sum, size_t i) {
      return i == 0 ? 0.0 : sum[i - 1];
    };
    size_t best = 0;
    double least = limits_.largest_conductance;
    for (size_t i = low + 1; i < high; ++i) {
      if (s.area[i - 1] - up_to(s.area, low) < limits_.least_area * area_) continue;
      if (s.area[high - 1] - s.area[i - 1] < limits_.least_area * area_) break;
      const double smaller =
          std::min(s.volume[i - 1] - up_to(s.volume, low), s.volume[high - 1] - s.volume[i - 1]);
      // Capacities are whole: less than half of one is rounding, and a closed door is no opening.
      if (!(s.crossing[i - 1] < least * smaller) || s.crossing[i - 1] < 0.5) continue;
      least = s.crossing[i - 1] / smaller;
      best = i;
    }
    if (best == 0) return;
    drops(s, low, best, found);
    found.push_back(best);
    drops(s, best, high, found);
  }

  // The minimum cut at a drop. Data term: patches are drawn to the sides by how far their potential
  // lies from it, in units of the plateaus' distances.
  MaxFlow cut_at(const std::vector<double>& u, double at, double low, double high) const {
    FlowNetwork net{net_.nodes, net_.source, net_.sink, {}};
    for (uint32_t v = 0; v < net_.nodes; ++v) {
      if (terminal(v)) continue;
      const double whole = problem_.samples[v] * problem_.scale;
      const double pull =
          u[v] < at ? (at - u[v]) / (at - low) : (u[v] - at) / std::max(high - at, 1e-300);
      const auto capacity = static_cast<int64_t>(std::llround(whole * std::min(1.0, pull)));
      if (capacity > 0)
        net.arcs.push_back(u[v] < at ? FlowArc{net_.source, v, capacity}
                                     : FlowArc{v, net_.sink, capacity});
    }
    for (const FlowArc& a : net_.arcs)
      if (!terminal(a.from) && !terminal(a.to)) net.arcs.push_back(a);
    return solve_(net);
  }

  // Mean potential of the rooms between the drops, by area.
  std::vector<double> plateaus(const Sweep& s, const std::vector<double>& u,
                               const std::vector<size_t>& found) const {
    std::vector<double> mean;
    size_t i = 0;
    for (size_t room = 0; room <= found.size(); ++room) {
      const size_t end = room < found.size() ? found[room] : s.order.size();
      double sum = 0, area = 0;
      for (; i < end; ++i)
        sum += u[s.order[i]] * problem_.samples[s.order[i]], area += problem_.samples[s.order[i]];
      mean.push_back(area > 0 ? sum / area : 0);
    }
    return mean;
  }

  // A door with the same potential on both sides is that of a closet. Of more drops than wanted the
  // widest go.
  void keep_real_drops(const Sweep& s, const std::vector<double>& u,
                       std::vector<size_t>& found) const {
    while (!found.empty()) {
      const std::vector<double> plateau = plateaus(s, u, found);
      size_t least = 0;
      for (size_t c = 0; c < found.size(); ++c)
        if (plateau[c + 1] - plateau[c] < plateau[least + 1] - plateau[least]) least = c;
      if (plateau[least + 1] - plateau[least] >= kLeastDrop) break;
      found.erase(found.begin() + static_cast<std::ptrdiff_t>(least));
    }
    while (found.size() > most_)
      found.erase(std::max_element(found.begin(), found.end(), [&](size_t a, size_t b) {
        return s.crossing[a - 1] < s.crossing[b - 1];
      }));
  }

  // The minimum cut of the network as it is; whether it is a bottleneck.
  bool minimum_cut() {
    const MaxFlow flow = solve_(net_);
    for (uint32_t v = 0; v < net_.nodes; ++v) result_.region[v] = flow.source_side[v] ? 0 : 1;
    const Sides sides = sides_of(0);
    result_.cuts = {{flow.value, sides.conductance()}};
    result_.reason = why_no_bottleneck(flow, sides);
    result_.bottleneck = result_.reason.empty();
    return result_.bottleneck;
  }

  // Whether light passes each of them.
  bool cuts_at(const Sweep& s, const std::vector<double>& u, const std::vector<size_t>& found) {
    const std::vector<double> plateau = plateaus(s, u, found);
    result_.cuts.clear();
    result_.reason.clear();
    result_.bottleneck = true;
    std::fill(result_.region.begin(), result_.region.end(), 0);
    for (size_t c = 0; c < found.size(); ++c) {
      const double at = 0.5 * (u[s.order[found[c] - 1]] + u[s.order[found[c]]]);
      const MaxFlow flow = cut_at(u, at, plateau[c], plateau[c + 1]);
      for (uint32_t v = 0; v < net_.nodes; ++v) result_.region[v] += !flow.source_side[v];
      result_.cuts.push_back({flow.value, 0});
    }
    for (size_t c = 0; c < result_.cuts.size(); ++c) {
      const Sides sides = sides_of(c);
      result_.cuts[c].conductance = sides.conductance();
      if (sides.crossing <= 0) return false;
    }
    return true;
  }

  const PatchNetwork& problem_;
  const FlowNetwork& net_;
  size_t most_;
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
