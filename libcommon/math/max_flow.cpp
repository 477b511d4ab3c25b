#include "libcommon/math/max_flow.h"

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/push_relabel_max_flow.hpp>

namespace tdpt {
namespace {

using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
struct EdgeState {
  int64_t capacity = 0, residual = 0;
  Traits::edge_descriptor reverse;
};
using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, boost::no_property,
                                    EdgeState>;

std::vector<uint8_t> residual_reach(const Graph& g, uint32_t source) {
  std::vector<uint8_t> reached(num_vertices(g), 0);
  std::vector<size_t> stack{source};
  reached[source] = 1;
  while (!stack.empty()) {
    const size_t v = stack.back();
    stack.pop_back();
    for (auto [e, end] = out_edges(v, g); e != end; ++e) {
      const size_t w = target(*e, g);
      if (g[*e].residual <= 0 || reached[w]) continue;
      reached[w] = 1;
      stack.push_back(w);
    }
  }
  return reached;
}

}  // namespace

MaxFlow max_flow(const FlowNetwork& network) {
  Graph g(network.nodes);
  std::vector<Traits::edge_descriptor> edges(network.arcs.size());
  for (size_t i = 0; i < network.arcs.size(); ++i) {
    const FlowArc& a = network.arcs[i];
    if (a.from == a.to) continue;  // carries nothing
    const auto forward = add_edge(a.from, a.to, g).first;
    const auto backward = add_edge(a.to, a.from, g).first;
    g[forward].capacity = a.capacity;
    g[forward].reverse = backward;
    g[backward].reverse = forward;
    edges[i] = forward;
  }
  MaxFlow result;
  result.value =
      boost::push_relabel_max_flow(g, network.source, network.sink,
                                   boost::capacity_map(boost::get(&EdgeState::capacity, g))
                                       .residual_capacity_map(boost::get(&EdgeState::residual, g))
                                       .reverse_edge_map(boost::get(&EdgeState::reverse, g)));
  result.flow.assign(network.arcs.size(), 0);
  for (size_t i = 0; i < network.arcs.size(); ++i)
    if (network.arcs[i].from != network.arcs[i].to)
      result.flow[i] = network.arcs[i].capacity - g[edges[i]].residual;
  result.source_side = residual_reach(g, network.source);
  return result;
}

}  // namespace tdpt
