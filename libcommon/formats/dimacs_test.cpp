#include "libcommon/formats/dimacs.h"

#include <gtest/gtest.h>

#include "libcommon/testing/files/refusal.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::dimacs_test {

DimacsFile read(const std::string& text) {
  const testing::TempFolder folder;
  return read_dimacs(folder.write("a.max", text));
}

DimacsFile example() {
  DimacsFile f;
  f.has_patches = true;
  f.scale = 1000;
  f.scene_hash = "0123456789abcdef";
  f.cameras = {"1.5 -2 0 0 0 -1 0 1 0 0.9 1.5 fronts the eye"};
  f.grid = {{-1.25, 0.1, 3e-7}, 0.1443};
  f.patches = {{3, 0, {1, -2, 7}, 120, {0.1, 0.2, 0.3}, {0, 1, 0}, {0, 2}},
               {4, 1, {4, 5, 6}, 3, {1, 2, 3}, {0.6, 0, -0.8}, {5}}};
  f.walks = {{0, 210, {12}}, {90, 40, {160}}};
  f.network = {4, 0, 1, {{0, 2, 500}, {2, 3, 250}, {3, 2, 250}, {3, 1, 700}}};
  f.provenance.made_by("ffgraph", "ffgraph");
  return f;
}

TEST(dimacs, reads_back_what_was_written) {
  DimacsFile a = example();
  Patch sky{};
  sky.node = 5, sky.samples = 77.5, sky.sky = 79;
  a.patches.push_back(sky);
  a.walks.push_back({9, 0, {0}});
  a.network.nodes = 5;
  a.network.arcs.push_back({4, 2, 60});
  const DimacsFile b = read(dimacs_text(a));
  EXPECT_EQ(dimacs_text(b), dimacs_text(a));
  ASSERT_EQ(b.patches.size(), 3u);
  EXPECT_FALSE(b.patches[1].is_sky());
  EXPECT_TRUE(b.patches[2].is_sky());
  EXPECT_EQ(b.scale, 1000);
  EXPECT_EQ(b.cameras, a.cameras);
  ASSERT_EQ(b.walks.size(), 3u);
  EXPECT_EQ(b.walks[1].begun, 90);
  EXPECT_EQ(b.walks[0].light, 210);
  EXPECT_EQ(b.walks[1].camera, std::vector<double>{160});
  EXPECT_EQ(b.network.arcs.size(), 5u);
  EXPECT_EQ(b.network.sink, 1u);
  EXPECT_EQ(b.provenance.lines, a.provenance.lines);
}

// The example with a second camera, whose sink is the last node.
DimacsFile of_two_cameras() {
  DimacsFile f = example();
  f.cameras.push_back("0 0 0 0 0 -1 0 1 0 0.9 1.5 all yard");
  f.walks = {{0, 210, {12, 5}}, {90, 40, {160, 0}}};
  f.light = {{0.5, {0.25, 0}}, {0, {1, 2}}};
  f.network.nodes = 5;
  f.more_sinks = {4};
  f.network.arcs.push_back({2, 4, 300});
  return f;
}

TEST(dimacs, reads_back_several_cameras) {
  const DimacsFile a = of_two_cameras(), b = read(dimacs_text(a));
  EXPECT_EQ(dimacs_text(b), dimacs_text(a));
  EXPECT_EQ(b.number_of_cameras(), 2u);
  EXPECT_EQ(b.walks[0].camera, a.walks[0].camera);
  EXPECT_EQ(b.light[1].importance, a.light[1].importance);
}

// Each camera has the arcs between patches and those to its own sink.
TEST(dimacs, has_a_network_for_each_camera) {
  const DimacsFile f = of_two_cameras();
  for (const size_t k : {0, 1}) {
    const FlowNetwork net = network_between(f, k).network;
    EXPECT_EQ(net.nodes, 4u);
    ASSERT_EQ(net.arcs.size(), 4u);
    const FlowArc& last = net.arcs.back();
    EXPECT_EQ(last.to, net.sink);
    EXPECT_EQ(last.from, k == 0 ? 3u : 2u);
    EXPECT_EQ(last.capacity, k == 0 ? 700 : 300);
  }
}

TEST(dimacs, says_what_is_wrong_with_several_cameras) {
  const auto said = [](const auto& change) {
    DimacsFile f = of_two_cameras();
    change(f);
    return testing::refusal([&] { read(dimacs_text(f)); });
  };
  EXPECT_EQ(said([](DimacsFile&) {}), "");
  using testing::names;
  EXPECT_TRUE(names(said([](DimacsFile& f) { f.more_sinks = {}; }), "", "0 more sinks"));
  EXPECT_TRUE(names(said([](DimacsFile& f) { f.more_sinks = {3}; }), "", "node 4 as sink"));
  EXPECT_TRUE(names(said([](DimacsFile& f) {
                      f.network.arcs.push_back({4, 2, 1});
                    }),
                    "", "node 5, a sink"));
  EXPECT_TRUE(names(said([](DimacsFile& f) { f.walks[0].camera.push_back(3); }), "line 13",
                    "the end of the line"));
}

TEST(dimacs, plain_problems_of_others_are_read) {
  const std::string problem =
      "p max 4 5\r\nn 1 s\nn 4 t\na 1 2 4\na 1 3 2\na 2 3 3\na 3 4 5\na 2 2 9";
  for (const char* comment : {"c a problem from a book\nc grid of streets\n\n", "c tdpt\n",
                              "c tdpt max\n", "c tdpt max flow\n", "c tdpt min 2\n"}) {
    const DimacsFile f = read(comment + problem);
    EXPECT_FALSE(f.has_patches);
    EXPECT_EQ(f.network.nodes, 4u);
    EXPECT_EQ(f.network.arcs.size(), 5u);
  }
}

TEST(dimacs, says_what_is_wrong_and_where) {
  const std::string p = "p max 4 2\nn 1 s\nn 4 t\n", arcs = "a 1 2 4\na 2 4 4\n";
  EXPECT_NO_THROW(read(p + arcs));
  testing::expect_refused(
      {
          {"", "", "no 'p max' line"},
          {"x\n", "line 1", "'x'"},
          {p + arcs + "c from " + std::string(5000, 'x') + '\0' + "\n", "", "is a binary file"},
          {"c tdpt max 2\n" + p + arcs, "line 1", "version 2"},
          {p + arcs + "c  tdpt max 10 \r\n", "line 6", "version 10"},
          {p + "p max 4 2\n", "line 4", "a second 'p' line"},
          {"p min 4 2\n", "line 1", "'min'"},
          {"p max 1 2\n", "line 1", "'1' as number of nodes"},
          {"p max 2147483647 0\n", "line 1", "at most 1048595"},
          {"p max 4 -1\n", "line 1", "'-1' as number of arcs"},
          {"p max 4 2 7\n", "line 1", "'7'"},
          {"n 1 s\n", "line 1", "needs the numbers of a 'p max' line"},
          {p + "n 2 s\n", "line 4", "a second source"},
          {p + "n 2 t\n", "line 4", "a second sink"},
          {"p max 4 0\nn 2 s\nn 2 t\n", "line 3", "the same node"},
          {p + "n 2 x\n", "line 4", "'x' as terminal"},
          {p + "a 0 2 1\n", "line 4", "'0' as tail"},
          {p + "a 1 5 1\n", "line 4", "'5' as head"},
          {p + "a 1 2 0.5\n", "line 4", "'0.5' as capacity"},
          {p + "a 1 2 -3\n", "line 4", "'-3' as capacity"},
          {p + "a 1 2 9223372036854775808\n", "line 4", "'9223372036854775808'"},
          {p + "a 1 2\n", "line 4", "nothing as capacity"},
          {p + "a 1 2 2000000000000000000\na 2 4 2000000000000000000\n", "line 5", "add up"},
          {p + arcs + "a 1 4 1\n", "line 6", "one arc more"},
          {p + "a 1 2 4\n", "", "1 arcs, expected the 2"},
          {"p max 4 0\nn 4 t\n", "", "no source"},
          {"p max 4 0\nn 4 s\n", "", "no sink"},
      },
      read);
  const std::string ours = "c tdpt max 1\nc scene aa\nc grid 0 0 0 1\n";
  const std::string patch_2 = "c patch 2 0 0 0 0 9 0 0 0 0 1 0\n";
  const std::string patches =
      patch_2 + "c faces 2 0\nc patch 3 0 0 0 0 9 0 0 0 0 1 0\nc faces 3 4 6\n";
  EXPECT_NO_THROW(read(ours + patches + p + arcs));
  EXPECT_NO_THROW(read(ours + patches + "c walks 2 1 2 3\n" + p + arcs)) << "of one patch only";
  testing::expect_refused(
      {
          {ours + patch_2 + "c walks 3 1 2 3\n", "line 5", "node 3 as node of walks"},
          {ours + patch_2 + "c walks 2 1 -2 3\n", "line 5", "a negative number of walks"},
          {"c tdpt max 1\nc scale 0\n", "line 2", "a scale of 0"},
          {ours + "c sky 2 7 1 5\n", "line 4", "'5' found"},
          {ours + p + arcs, "", "0 patches, expected one for each of the 2"},
          {ours + "c sky 1 7 1\n" + p + arcs, "", "patch 1 is no inner node"},
          {ours + "c scale 1e300\n" + patch_2 + "c faces 2 0\n" + p + arcs, "", "9e+300"},
      },
      read);
}

}  // namespace tdpt::dimacs_test
