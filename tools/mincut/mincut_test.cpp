#include <cstdio>
#include <tuple>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/math/rng.h"
#include "libcommon/testing/files/temp_folder.h"
#include "tools/mincut/cut_of.h"

namespace tdpt::mincut_test {

FlowNetwork random_network(uint64_t seed, uint32_t nodes, uint32_t arcs, uint32_t largest) {
  Rng rng(seed, 1, 0);
  FlowNetwork net{nodes, 0, 1, {}};
  for (uint32_t i = 0; i < arcs; ++i) {
    const uint32_t from = rng.below(nodes);
    const uint32_t to = rng.below(nodes);
    net.arcs.push_back({from, to, rng.below(largest)});
  }
  return net;
}

// s -> 2 -> t with capacities 5 and 3.
TEST(verify, refutes_every_planted_fault) {
  const FlowNetwork net{3, 0, 1, {{0, 2, 5}, {2, 1, 3}}};
  const auto refutation = [&](const MaxFlow& result) -> std::string {
    try {
      verify_max_flow(net, result);
      return "accepted";
    } catch (const Error& e) {
      EXPECT_EQ(e.code, Exit::internal);
      return e.what();
    }
  };
  EXPECT_EQ(refutation({3, {3, 3}, {1, 0, 1}}), "accepted");
  for (const auto& [wrong, words] : std::vector<std::pair<MaxFlow, const char*>>{
           {{3, {4, 3}, {1, 0, 1}}, "node 3 keeps 1"},
           {{3, {3, 4}, {1, 0, 1}}, "arc 2 carries 4"},
           {{3, {-1, 3}, {1, 0, 1}}, "arc 1 carries -1"},
           {{2, {2, 2}, {1, 0, 1}}, "the cut holds 3, expected the flow 2"},
           {{3, {3, 3}, {1, 0, 0}}, "the cut holds 5, expected the flow 3"},
           {{3, {3, 3}, {1, 1, 1}}, "the sink is on"},
           {{3, {3, 3}, {0, 0, 1}}, "the source is not on"},
           {{4, {3, 3}, {1, 0, 1}}, "3 arrives"},
           {{3, {3}, {1, 0, 1}}, "1 flows"},
           {{3, {3, 3}, {1, 0}}, "2 sides"}})
    EXPECT_NE(refutation(wrong).find(words), std::string::npos) << refutation(wrong);
}

// The value of the flow by LEMON's solver.
std::string by_dimacs_solver(const FlowNetwork& network) {
  DimacsFile file;
  file.network = network;
  const testing::TempFolder folder;
  const std::string path = folder.write("network.max", dimacs_text(file));
  std::FILE* pipe = ::popen(("dimacs-solver -long " + path + " 2>&1").c_str(), "r");
  std::string text;
  for (int c; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  ::pclose(pipe);
  const std::string key = "Max flow value: ";
  const size_t at = text.find(key);
  return at == std::string::npos ? text : std::to_string(std::stoll(text.substr(at + key.size())));
}

bool has_dimacs_solver() {
  return std::system("command -v dimacs-solver >/dev/null 2>&1") == 0;
}

// LEMON's solver as an independent judge, if installed.
TEST(max_flow, is_that_of_dimacs_solver) {
  if (!has_dimacs_solver()) GTEST_SKIP() << "dimacs-solver is not installed";
  for (uint64_t seed = 0; seed < 10; ++seed) {
    FlowNetwork network = random_network(seed, 400, 8000, 1u << 31);
    for (FlowArc& a : network.arcs) a.capacity <<= 12;
    EXPECT_EQ(by_dimacs_solver(network), std::to_string(max_flow(network).value));
  }
}

// A few nodes with loops, parallel arcs, capacities of 0, and opposite arcs one after the other, at
// the terminals too.
FlowNetwork knotted_network(uint64_t seed) {
  Rng rng(seed, 2, 0);
  FlowNetwork net{2 + rng.below(7), 0, 1, {}};
  const uint32_t arcs = rng.below(4 * net.nodes);
  for (uint32_t i = 0; i < arcs; ++i) {
    const uint32_t from = rng.below(net.nodes);
    const uint32_t to = rng.below(net.nodes);
    net.arcs.push_back({from, to, rng.below(6)});
    if (rng.below(2) == 0) net.arcs.push_back({to, from, rng.below(6)});
  }
  return net;
}

// Each is verified by itself; to LEMON they are one network, joined at source and sink.
TEST(max_flow, of_ten_thousand_knotted_networks_is_verified_and_that_of_dimacs_solver) {
  FlowNetwork all{2, 0, 1, {}};
  int64_t sum = 0;
  for (uint64_t seed = 0; seed < 10'000; ++seed) {
    const FlowNetwork net = knotted_network(seed);
    const MaxFlow flow = max_flow(net);
    ASSERT_NO_THROW(verify_max_flow(net, flow)) << seed;
    sum += flow.value;
    const auto joined = [&](uint32_t v) { return v < 2 ? v : v - 2 + all.nodes; };
    for (const FlowArc& a : net.arcs)
      all.arcs.push_back({joined(a.from), joined(a.to), a.capacity});
    all.nodes += net.nodes - 2;
  }
  EXPECT_EQ(max_flow(all).value, sum);
  if (!has_dimacs_solver()) GTEST_SKIP() << "dimacs-solver is not installed";
  EXPECT_EQ(by_dimacs_solver(all), std::to_string(sum));
}

// Two rooms of two patches each, joined by `door`.
DimacsFile two_rooms(int64_t door, double small_area = 50) {
  DimacsFile f;
  f.has_patches = true;
  f.scale = 10;
  f.scene_hash = "abc";
  for (uint32_t k = 0; k < 4; ++k)
    f.patches.push_back(
        {k + 3, 0, {int(k), 0, 0}, k < 2 ? small_area : 50, {}, {0, 1, 0}, {2 * k}});
  f.network = {6, 0, 1, {{0, 2, 900}, {0, 3, 900}, {4, 1, 900}, {5, 1, 900}}};
  const auto both = [&f](uint32_t a, uint32_t b, int64_t c) {
    f.network.arcs.push_back({a, b, c});
    f.network.arcs.push_back({b, a, c});
  };
  both(2, 3, static_cast<int64_t>(10 * small_area));
  both(4, 5, 500);
  both(3, 4, door);
  return f;
}

TEST(cut_of, a_narrow_door_is_a_bottleneck_with_its_pivot_pair) {
  const DimacsFile f = two_rooms(20);
  const CutFile cut = cut_of(f, 8, {}).file;
  EXPECT_TRUE(cut.bottleneck) << cut.reason;
  ASSERT_EQ(cut.cuts.size(), 1u);
  EXPECT_EQ(cut.cuts[0].flow, 2);
  ASSERT_EQ(cut.arcs.size(), 1u);
  EXPECT_EQ(cut.arcs[0].from, 1u);
  EXPECT_EQ(cut.arcs[0].to, 2u);
  EXPECT_EQ(cut.arcs[0].capacity, 2);
  EXPECT_NEAR(cut.cuts[0].conductance, 20.0 / 1020, 1e-12);
  EXPECT_EQ(cut.sides, (std::vector<uint64_t>{0, 0, 1, 1}));
}

// A wide door, a side almost without surface, and a door that is shut.
TEST(cut_of, what_is_no_bottleneck_has_a_reason) {
  for (const auto& [door, area, words] : std::vector<std::tuple<int64_t, double, const char*>>{
           {300, 50, "0.23 of the smaller side's light crosses the cut, more than 0.12"},
           {5, 0.5, "1.0 % of the surface and 1.5 % of the exchanged light, less than 3.0 %"},
           {0, 50, "no light was found to reach the camera's room"}}) {
    const CutFile cut = cut_of(two_rooms(door, area), 8, {}).file;
    EXPECT_FALSE(cut.bottleneck);
    EXPECT_NE(cut.reason.find(words), std::string::npos) << cut.reason;
  }
}

// Two rooms joined by a door, and a camera in each; the lamp is in the first room.
DimacsFile camera_in_each_room() {
  DimacsFile f = two_rooms(20);
  f.cameras = {"0 0 0 0 0 -1 0 1 0 0.9 1.5 all far", "1 0 0 0 0 -1 0 1 0 0.9 1.5 all near"};
  f.network.nodes = 7;
  f.more_sinks = {6};
  for (const uint32_t node : {2, 3}) f.network.arcs.push_back({node, 6, 900});
  return f;
}

// As one sink of both cameras the network has no door: light and camera share the first room. A
// third camera beside the first has a cut of its own through the same door.
TEST(cut_of, each_camera_has_its_own_cuts) {
  DimacsFile f = camera_in_each_room();
  f.cameras.push_back("2 0 0 0 0 -1 0 1 0 0.9 1.5 all far too");
  f.network.nodes = 8;
  f.more_sinks.push_back(7);
  f.network.arcs.push_back({4, 7, 700});
  f.network.arcs.push_back({5, 7, 900});
  const FoundCuts found = cut_of(f, 8, {});
  EXPECT_TRUE(found.file.bottleneck);
  ASSERT_EQ(found.file.cuts.size(), 2u);
  EXPECT_EQ(found.file.cuts[0].camera, 0u);
  EXPECT_EQ(found.file.cuts[1].camera, 2u);
  EXPECT_EQ(found.file.sides, (std::vector<uint64_t>{0, 0, 3, 3}));
  EXPECT_EQ(found.cameras[0].reason, "");
  EXPECT_NE(found.cameras[1].reason, "");
}

// More cameras than a file has room for: as many have their door.
TEST(cut_of, a_file_holds_no_more_cuts_than_it_has_sides_for) {
  DimacsFile f = two_rooms(20);
  f.cameras.assign(kMostCuts + 3, "0 0 0 0 0 -1 0 1 0 0.9 1.5 all far");
  for (uint32_t k = 1; k < f.cameras.size(); ++k) {
    f.more_sinks.push_back(f.network.nodes);
    for (const uint32_t node : {4, 5}) f.network.arcs.push_back({node, f.network.nodes, 900});
    ++f.network.nodes;
  }
  const FoundCuts found = cut_of(f, 8, {});
  EXPECT_EQ(found.file.cuts.size(), kMostCuts);
  EXPECT_EQ(found.facts.size(), kMostCuts);
}

}  // namespace tdpt::mincut_test
