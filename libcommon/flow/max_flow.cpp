#include "libcommon/flow/max_flow.h"

#include <algorithm>
#include <numeric>

#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <boost/graph/compressed_sparse_row_graph.hpp>

namespace tdpt {
namespace {

// The edge_descriptor of Graph.
using Edge = boost::detail::csr_edge_descriptor<uint32_t, uint32_t>;
using Graph =
    boost::compressed_sparse_row_graph<boost::directedS, boost::no_property, boost::no_property,
                                       boost::no_property, uint32_t, uint32_t>;

std::vector<uint8_t> residual_reach(const Graph& g, const std::vector<int64_t>& residual,
                                    uint32_t source) {
  std::vector<uint8_t> reached(num_vertices(g), 0);
  std::vector<uint32_t> stack{source};
  reached[source] = 1;
  while (!stack.empty()) {
    const uint32_t v = stack.back();
    stack.pop_back();
    for (auto [e, end] = out_edges(v, g); e != end; ++e) {
      const uint32_t w = target(*e, g);
      if (residual[(*e).idx] <= 0 || reached[w]) continue;
      reached[w] = 1;
      stack.push_back(w);
    }
  }
  return reached;
}

}  // namespace

// Each arc gives an edge and its reverse; the reverse is the next arc's, if that leads back, as
// ffgraph writes them. The edges of a node are contiguous, in the order of the arcs; loops carry
// nothing and are skipped.
struct FlowGraph::Layout {
  Graph graph;
  std::vector<Edge> reverse;   // of each edge
  std::vector<uint32_t> edge;  // per arc; of a loop UINT32_MAX
};

FlowGraph::FlowGraph(const FlowNetwork& network) {
  const std::vector<FlowArc>& arcs = network.arcs;
  const auto leads_back = [&](size_t i) {
    return i + 1 < arcs.size() && arcs[i + 1].from == arcs[i].to && arcs[i + 1].to == arcs[i].from;
  };
  const auto each_pair = [&](const auto& visit) {
    for (size_t i = 0; i < arcs.size(); ++i) {
      if (arcs[i].from == arcs[i].to) continue;
      visit(i);
      i += leads_back(i);
    }
  };
  auto layout = std::make_shared<Layout>();
  std::vector<uint32_t> next(size_t{network.nodes} + 1, 0);
  each_pair([&](size_t i) { ++next[arcs[i].from + 1], ++next[arcs[i].to + 1]; });
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::pair<uint32_t, uint32_t>> ends(next.back());
  layout->reverse.resize(next.back());
  layout->edge.assign(arcs.size(), UINT32_MAX);
  each_pair([&](size_t i) {
    const FlowArc& a = arcs[i];
    const Edge forward(a.from, next[a.from]++), backward(a.to, next[a.to]++);
    ends[forward.idx] = {a.from, a.to};
    ends[backward.idx] = {a.to, a.from};
    layout->reverse[forward.idx] = backward;
    layout->reverse[backward.idx] = forward;
    layout->edge[i] = forward.idx;
    if (leads_back(i)) layout->edge[i + 1] = backward.idx;
  });
  layout->graph =
      Graph(boost::edges_are_sorted, ends.begin(), ends.end(), network.nodes, ends.size());
  layout_ = std::move(layout);
}

MaxFlow FlowGraph::solve(const FlowNetwork& network) const {
  const Graph& g = layout_->graph;
  const std::vector<FlowArc>& arcs = network.arcs;
  const auto& [graph, reverse, edge] = *layout_;
  std::vector<int64_t> capacity(reverse.size(), 0), residual(reverse.size());  // of each edge
  for (size_t i = 0; i < arcs.size(); ++i)
    if (edge[i] != UINT32_MAX) capacity[edge[i]] = arcs[i].capacity;
  const auto index = boost::get(boost::vertex_index, g);
  const auto per_node = [&](auto& values) {
    return boost::make_iterator_property_map(values.begin(), index);
  };
  const auto per_edge = [&](auto& values) {
    return boost::make_iterator_property_map(values.begin(), boost::get(boost::edge_index, g));
  };
  std::vector<Edge> parent(network.nodes);
  std::vector<boost::default_color_type> tree(network.nodes);
  std::vector<uint32_t> distance(network.nodes);
  MaxFlow result;
  result.value = boost::boykov_kolmogorov_max_flow(
      g, per_edge(capacity), per_edge(residual), per_edge(reverse), per_node(parent),
      per_node(tree), per_node(distance), index, network.source, network.sink);
  // At most one of two arcs that are one edge carries flow. Boost leaves the reverse of an edge at
  // the source or the sink as it was, so that each arc asks its own.
  result.flow.assign(arcs.size(), 0);
  for (size_t i = 0; i < arcs.size(); ++i)
    if (edge[i] != UINT32_MAX)
      result.flow[i] = std::max<int64_t>(arcs[i].capacity - residual[edge[i]], 0);
  result.source_side = residual_reach(g, residual, network.source);
  return result;
}

MaxFlow max_flow(const FlowNetwork& network) {
  return FlowGraph(network).solve(network);
}

}  // namespace tdpt
