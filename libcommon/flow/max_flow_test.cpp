#include "libcommon/flow/max_flow.h"

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"

namespace tdpt::max_flow_test {

FlowNetwork random_network(uint64_t seed) {
  Rng rng(seed, 0, 0);
  FlowNetwork net;
  net.nodes = 2 + rng.below(9);
  net.source = rng.below(net.nodes);
  do {
    net.sink = rng.below(net.nodes);
  } while (net.sink == net.source);
  const uint32_t arcs = rng.below(4 * net.nodes);
  for (uint32_t i = 0; i < arcs; ++i) {
    const uint32_t from = rng.below(net.nodes);
    const uint32_t to = rng.below(net.nodes);
    net.arcs.push_back({from, to, rng.below(20)});
  }
  return net;
}

int64_t capacity_of(const FlowNetwork& net, uint32_t source_set) {
  int64_t sum = 0;
  for (const FlowArc& a : net.arcs)
    if ((source_set >> a.from & 1) && !(source_set >> a.to & 1)) sum += a.capacity;
  return sum;
}

/// Minimum capacity over all 2^(n-2) partitions.
int64_t brute_force(const FlowNetwork& net) {
  int64_t best = INT64_MAX;
  for (uint32_t set = 0; set < 1u << net.nodes; ++set)
    if ((set >> net.source & 1) && !(set >> net.sink & 1))
      best = std::min(best, capacity_of(net, set));
  return best;
}

TEST(max_flow, equals_the_smallest_of_all_partitions_on_a_thousand_small_networks) {
  for (uint64_t seed = 0; seed < 1000; ++seed) {
    const FlowNetwork net = random_network(seed);
    const MaxFlow result = max_flow(net);
    ASSERT_EQ(result.value, brute_force(net)) << seed;
    uint32_t set = 0;
    for (uint32_t v = 0; v < net.nodes; ++v) set |= uint32_t{result.source_side[v]} << v;
    ASSERT_TRUE(set >> net.source & 1);
    ASSERT_FALSE(set >> net.sink & 1);
    ASSERT_EQ(capacity_of(net, set), result.value) << seed;
  }
  // Twin: an arc is missing.
  int caught = 0;
  for (uint64_t seed = 0; seed < 200; ++seed) {
    FlowNetwork net = random_network(seed);
    const int64_t truth = brute_force(net);
    if (!net.arcs.empty()) net.arcs.pop_back();
    caught += max_flow(net).value != truth;
  }
  EXPECT_GT(caught, 10);
}

TEST(max_flow, scales_with_its_capacities_and_ignores_the_names_of_nodes) {
  for (uint64_t seed = 0; seed < 100; ++seed) {
    FlowNetwork net = random_network(seed);
    const int64_t value = max_flow(net).value;
    for (FlowArc& a : net.arcs) {
      a.capacity *= int64_t{1} << 40;
      a.from = net.nodes - 1 - a.from;
      a.to = net.nodes - 1 - a.to;
    }
    net.source = net.nodes - 1 - net.source;
    net.sink = net.nodes - 1 - net.sink;
    EXPECT_EQ(max_flow(net).value, value << 40);
  }
}

// An arc and the next, which leads back, are one edge: its flow may run either way.
TEST(max_flow, tells_the_flow_of_arcs_that_lead_back) {
  const MaxFlow back = max_flow({4, 0, 1, {{0, 2, 5}, {3, 2, 4}, {2, 3, 3}, {3, 1, 5}}});
  EXPECT_EQ(back.value, 3);
  EXPECT_EQ(back.flow, (std::vector<int64_t>{3, 0, 3, 3}));
  EXPECT_EQ(back.source_side, (std::vector<uint8_t>{1, 0, 1, 0}));
  const MaxFlow forth = max_flow({4, 0, 1, {{0, 2, 5}, {2, 3, 3}, {3, 2, 4}, {3, 1, 5}}});
  EXPECT_EQ(forth.flow, (std::vector<int64_t>{3, 3, 0, 3}));
}

// An arc into the source or out of the sink is the first of such a pair: the solver does not tell
// the two residuals of an edge at a terminal from each other.
TEST(max_flow, tells_the_flow_of_arcs_that_lead_back_at_the_source_and_the_sink) {
  const MaxFlow direct = max_flow({2, 0, 1, {{1, 0, 1}, {0, 1, 1}}});
  EXPECT_EQ(direct.flow, (std::vector<int64_t>{0, 1}));
  const MaxFlow by_a_node = max_flow({3, 0, 1, {{2, 0, 4}, {0, 2, 5}, {1, 2, 2}, {2, 1, 3}}});
  EXPECT_EQ(by_a_node.flow, (std::vector<int64_t>{0, 3, 0, 3}));
}

TEST(max_flow, is_0_without_a_path) {
  EXPECT_EQ(max_flow({3, 0, 1, {{0, 2, 5}, {1, 2, 5}}}).value, 0);
  EXPECT_EQ(max_flow({2, 0, 1, {}}).value, 0);
}

}  // namespace tdpt::max_flow_test
