#include "libcommon/math/max_flow.h"

#include <numeric>

#include <boost/graph/compressed_sparse_row_graph.hpp>
#include <boost/graph/push_relabel_max_flow.hpp>

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
  // Each arc gives an edge and its reverse of capacity 0. The edges of a node are contiguous, in
  // the order of the arcs; loops carry nothing and are skipped.
  const auto is_edge = [](const FlowArc& a) { return a.from != a.to; };
  std::vector<uint32_t> next(size_t{network.nodes} + 1, 0);
  for (const FlowArc& a : network.arcs)
    if (is_edge(a)) ++next[a.from + 1], ++next[a.to + 1];
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::pair<uint32_t, uint32_t>> ends(next.back());
  std::vector<EdgeState> state(next.back());
  std::vector<Edge> edges(network.arcs.size());
  for (size_t i = 0; i < network.arcs.size(); ++i) {
    const FlowArc& a = network.arcs[i];
    if (!is_edge(a)) continue;
    const Edge forward(a.from, next[a.from]++), backward(a.to, next[a.to]++);
    ends[forward.idx] = {a.from, a.to};
    ends[backward.idx] = {a.to, a.from};
    state[forward.idx] = {a.capacity, 0, backward};
    state[backward.idx] = {0, 0, forward};
    edges[i] = forward;
  }
  Graph g(boost::edges_are_sorted, ends.begin(), ends.end(), state.begin(), network.nodes,
          ends.size());
  MaxFlow result;
  result.value =
      boost::push_relabel_max_flow(g, network.source, network.sink,
                                   boost::capacity_map(boost::get(&EdgeState::capacity, g))
                                       .residual_capacity_map(boost::get(&EdgeState::residual, g))
                                       .reverse_edge_map(boost::get(&EdgeState::reverse, g)));
  result.flow.assign(network.arcs.size(), 0);
  for (size_t i = 0; i < network.arcs.size(); ++i)
    if (is_edge(network.arcs[i])) result.flow[i] = network.arcs[i].capacity - g[edges[i]].residual;
  result.source_side = residual_reach(g, network.source);
  return result;
}

}  // namespace tdpt
