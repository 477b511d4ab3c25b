// The potential of a resistor network, and the sweep cuts over it.
//
// Method: random-walker segmentation (Grady 2006), solved by conjugate gradients.
//
// u_i       potential of patch i
// c_ij      half the capacity of the arcs between i and j, both directions
// a_i, h_i  where the potential of patch i is held, and with which conductance
//   sum_j c_ij (u_i - u_j) + h_i (u_i - a_i) = 0
// a_i = log(v_i / b_i), a little on every patch [PatchNetwork]; so rooms are distinguished by which
// end reaches them better, even if both reach all of them.
#include "libcommon/flow/potential_sweep.h"

#include <cmath>
#include <numeric>

namespace tdpt {
namespace {

constexpr int kMostIterations = 2000;
constexpr double kResidual = 1e-9;  // relative, of the conjugate gradients
constexpr double kFaintest = 1e-5;  // of the mean: less counts as this
constexpr double kHold = 0.3;       // conductance that holds a potential, of the samples
constexpr double kPinned = 1000;    // the same, that leaves it where it is held

// The resistors: conductances c_ij in compressed rows, and the arcs of the terminals.
struct Links {
  struct Link {
    uint32_t to;
    double capacity;
  };
  std::vector<size_t> first;  // links of node v: first[v] .. first[v + 1]
  std::vector<Link> links;
  std::vector<double> total;                 // sum over each node's links
  std::vector<double> from_source, to_sink;  // per node
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
    // The two directions of an arc are averaged.
    const double half = 0.5 * static_cast<double>(a.capacity);
    l.links[next[a.from]++] = {a.to, half};
    l.links[next[a.to]++] = {a.from, half};
    l.total[a.from] += half;
    l.total[a.to] += half;
  }
  return l;
}

// What holds the potential of a node: where, and how strongly [share of its samples].
struct Hold {
  double at = 0, strength = 0;
};

// log(v_i / b_i), in units of their means, a mean over the node's surroundings: from room to room
// light falls by a factor, and the camera's part rises. All of the sky is one light, bright or not.
std::vector<Hold> holds_of(const PatchNetwork& p, const Links& l) {
  // Per sample of each node; where they are unknown, the walks that hit it, or else the terminals'
  // part of it.
  const bool known = !p.brightness.empty(), walked = !p.lit.empty();
  std::vector<double> light = known    ? p.brightness
                              : walked ? p.lit
                                       : l.from_source,
                      use = known    ? p.importance
                            : walked ? p.viewed
                                     : l.to_sink;
  double samples = 0, brightness = 0, importance = 0;
  for (uint32_t v = 0; v < p.network.nodes; ++v) {
    for (std::vector<double>* of : {&light, &use})
      if (!known) (*of)[v] = p.samples[v] > 0 ? (*of)[v] / p.samples[v] : 0;
    samples += p.samples[v];
    brightness += p.samples[v] * light[v];
    importance += p.samples[v] * use[v];
  }
  std::vector<Hold> holds(p.network.nodes);
  if (!(brightness > 0 && importance > 0)) return holds;
  for (uint32_t v = 0; v < p.network.nodes; ++v) {
    const double b = light[v] * samples / brightness, i = use[v] * samples / importance;
    if (p.is_sky(v))
      holds[v] = {2 * std::log(kFaintest), kPinned};
    else if (b > 0 || i > 0)
      holds[v] = {std::log(std::max(i, kFaintest) / std::max(b, kFaintest)), kHold};
  }
  return holds;
}

// Solves for u with diagonally preconditioned conjugate gradients.
std::vector<double> potential_of(const PatchNetwork& p, const Links& l) {
  const uint32_t n = p.network.nodes;
  const std::vector<Hold> holds = holds_of(p, l);
  std::vector<double> diagonal(n), right(n, 0), u(n, 0.5);
  for (uint32_t v = 0; v < n; ++v) {
    const double whole = p.samples[v] * p.scale;
    const double hold = holds[v].strength * whole;
    // Isolated patches that nothing pins stay at 1/2.
    const double loose = 1e-9 * whole + 1e-30;
    diagonal[v] = l.total[v] + hold + loose;
    right[v] = holds[v].at * hold + 0.5 * loose;
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

}  // namespace

Sweep sweep_of(const PatchNetwork& p) {
  const Links links = links_of(p);
  Sweep s;
  s.u = potential_of(p, links);
  for (uint32_t v = 0; v < p.network.nodes; ++v)
    if (!p.terminal(v)) s.order.push_back(v);
  std::sort(s.order.begin(), s.order.end(),
            [&](uint32_t a, uint32_t b) { return s.u[a] != s.u[b] ? s.u[a] < s.u[b] : a < b; });
  std::vector<uint8_t> passed(p.network.nodes, 0);
  double crossing = 0;
  s.before.emplace_back();
  for (const uint32_t v : s.order) {
    passed[v] = 1;
    for (size_t k = links.first[v]; k < links.first[v + 1]; ++k)
      crossing += passed[links.links[k].to] ? -links.links[k].capacity : links.links[k].capacity;
    s.before.push_back(s.before.back());
    s.before.back() += {p.samples[v], links.total[v], p.weight_of(v)};
    s.crossing.push_back(crossing);
  }
  return s;
}

std::vector<double> terminal_grades(const std::vector<double>& light,
                                    const std::vector<double>& size,
                                    const std::vector<double>& weight) {
  std::vector<double> grade(light.size(), 0);
  std::vector<std::pair<double, double>> densities;  // with their weights
  double total = 0, below = 0, median = 0;
  for (size_t i = 0; i < light.size(); ++i)
    if (size[i] > 0 && light[i] > 0)
      grade[i] = light[i] / size[i], densities.emplace_back(grade[i], weight[i]),
      total += weight[i];
  std::sort(densities.begin(), densities.end());
  for (const auto& [density, w] : densities) {
    median = density;
    if ((below += w) >= 0.5 * total) break;
  }
  for (double& g : grade)
    if (g > 0) g = std::min(1.0, g / (0.5 * median));
  return grade;
}

}  // namespace tdpt
