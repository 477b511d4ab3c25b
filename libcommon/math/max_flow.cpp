#include "libcommon/math/max_flow.h"

#include <algorithm>
#include <numeric>

#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>

namespace tdpt {
namespace {

// The edge_descriptor of Graph, whose edge properties hold some.
using Edge = boost::detail::csr_edge_descriptor<uint32_t, uint32_t>;
struct EdgeState {
  int64_t capacity = 0, residual = 0;
  Edge reverse;
};
using Graph = boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, EdgeState,
                                                 boost::no_property, uint32_t, uint32_t>;

std::vector<uint8_t> residual_reach(const Graph& g, uint32_t source) {
  std::vector<uint8_t> reached(num_vertices(g), 0);
  std::vector<uint32_t> stack{source};
  reached[source] = 1;
  while (!stack.empty()) {
    const uint32_t v = stack.back();
    stack.pop_back();
    for (auto [e, end] = out_edges(v, g); e != end; ++e) {
      const uint32_t w = target(*e, g);
      if (g[*e].residual <= 0 || reached[w]) continue;
      reached[w] = 1;
      stack.push_back(w);
    }
  }
  return reached;
}

}  // namespace

MaxFlow max_flow(const FlowNetwork& network) {
  // Each arc gives an edge and its reverse; the reverse has the capacity of the next arc, if that
  // leads back, as ffgraph writes them. The edges of a node are contiguous, in the order of the
  // arcs; loops carry nothing and are skipped.
  const std::vector<FlowArc>& arcs = network.arcs;
  const auto leads_back = [&](size_t i) {
    return i + 1 < arcs.size() && arcs[i + 1].from == arcs[i].to && arcs[i + 1].to == arcs[i].from;
  };
  const auto each_pair = [&](const auto& visit) {
    for (size_t i = 0; i < arcs.size(); ++i) {
      if (arcs[i].from == arcs[i].to) continue;
      const bool both = leads_back(i);
      visit(i, both ? arcs[i + 1].capacity : 0);
      i += both;
    }
  };
  std::vector<uint32_t> next(size_t{network.nodes} + 1, 0);
  each_pair([&](size_t i, int64_t) { ++next[arcs[i].from + 1], ++next[arcs[i].to + 1]; });
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::pair<uint32_t, uint32_t>> ends(next.back());
  std::vector<EdgeState> state(next.back());
  std::vector<Edge> edges(arcs.size());
  each_pair([&](size_t i, int64_t back) {
    const FlowArc& a = arcs[i];
    const Edge forward(a.from, next[a.from]++), backward(a.to, next[a.to]++);
    ends[forward.idx] = {a.from, a.to};
    ends[backward.idx] = {a.to, a.from};
    state[forward.idx] = {a.capacity, 0, backward};
    state[backward.idx] = {back, 0, forward};
    edges[i] = forward;
  });
  Graph g(boost::edges_are_sorted, ends.begin(), ends.end(), state.begin(), network.nodes,
          ends.size());
  const auto index = boost::get(boost::vertex_index, g);
  const auto per_node = [&](auto& values) {
    return boost::make_iterator_property_map(values.begin(), index);
  };
  std::vector<Edge> parent(network.nodes);
  std::vector<boost::default_color_type> tree(network.nodes);
  std::vector<uint32_t> distance(network.nodes);
  MaxFlow result;
  result.value = boost::boykov_kolmogorov_max_flow(
      g, boost::get(&EdgeState::capacity, g), boost::get(&EdgeState::residual, g),
      boost::get(&EdgeState::reverse, g), per_node(parent), per_node(tree), per_node(distance),
      index, network.source, network.sink);
  result.flow.assign(arcs.size(), 0);
  each_pair([&](size_t i, int64_t) {
    const int64_t flow = arcs[i].capacity - g[edges[i]].residual;
    result.flow[i] = std::max<int64_t>(flow, 0);
    if (flow < 0) result.flow[i + 1] = -flow;
  });
  result.source_side = residual_reach(g, network.source);
  return result;
}

}  // namespace tdpt
