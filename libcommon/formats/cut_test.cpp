#include "libcommon/formats/cut.h"

#include <gtest/gtest.h>

#include "libcommon/formats/viewpoint.h"
#include "libcommon/testing/files/refusal.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::cut_test {

CutFile read(const std::string& text) {
  const testing::TempFolder folder;
  return read_cut(folder.write("a.cut", text));
}

CutFile example() {
  CutFile f;
  f.scene_hash = "0123456789abcdef";
  f.cameras = {"1.5 -2 0 0 0 -1 0 1 0 0.9 1.5 fronts the eye"};
  f.grid = {{-1.25, 0.1, 3e-7}, 0.1443};
  f.patches = {{3, 0, {1, -2, 7}, 120, {0.1, 0.2, 0.3}, {0, 1, 0}, {0, 2}},
               {9, 1, {4, 5, 6}, 3, {1, 2, 3}, {0.6, 0, -0.8}, {5}}};
  for (uint32_t k = 0; k < 40; ++k) f.patches[1].faces.push_back(2 * k + 7);
  f.sides = {0, 1};
  f.cuts = {{2.75, 0.015}};
  f.arcs = {{0, 1, 2.5}};
  f.bottleneck = true;
  f.provenance.made_by("mincut", "mincut");
  f.provenance.from("room.max", "77");
  return f;
}

TEST(cut, reads_back_what_was_written) {
  CutFile a = example();
  Patch sky{};
  sky.node = 11, sky.samples = 40, sky.sky = 3;
  a.patches.push_back(sky);
  a.sides.push_back(0);
  a.arcs.push_back({2, 1, 0.5});
  const CutFile b = read(cut_text(a));
  EXPECT_EQ(cut_text(b), cut_text(a));
  ASSERT_EQ(b.patches.size(), 3u);
  EXPECT_EQ(b.patches[1].faces, a.patches[1].faces);
  EXPECT_EQ(b.patches[0].cell, a.patches[0].cell);
  EXPECT_EQ(b.patches[2].sky, 3);
  EXPECT_EQ(b.patches[2].samples, 40);
  EXPECT_EQ(b.grid.base_cell, a.grid.base_cell);
  EXPECT_EQ(b.sides, a.sides);
  EXPECT_EQ(b.cameras, a.cameras);
  EXPECT_EQ(b.arcs[0].capacity, 2.5);
  ASSERT_EQ(b.cuts.size(), 1u);
  EXPECT_EQ(b.cuts[0].flow, 2.75);
  EXPECT_EQ(b.cuts[0].conductance, 0.015);
  EXPECT_TRUE(b.bottleneck);
  EXPECT_EQ(b.provenance.lines, a.provenance.lines);
  EXPECT_EQ(b.hash.size(), 32u);
}

// Cuts need not be nested: each patch has its side of each.
TEST(cut, reads_back_cuts_of_several_cameras) {
  CutFile a = example();
  a.cameras.push_back("0 0 0 0 0 -1 0 1 0 0.9 1.5 all yard");
  a.light = {{0.5, {0.25, 0}}, {0, {1, 2}}};
  a.cuts = {{2.75, 0.015, 0}, {1, 0.02, 1}, {3, 0.5, 0}};
  a.sides = {0b010, 0b101};
  a.arcs.push_back({1, 0, 0.5});
  const CutFile b = read(cut_text(a));
  EXPECT_EQ(cut_text(b), cut_text(a));
  EXPECT_NE(cut_text(a).find("\nn 3 010 "), std::string::npos) << "the first cut's digit is first";
  EXPECT_EQ(b.sides, a.sides);
  EXPECT_EQ(b.light[1].importance, a.light[1].importance);
  EXPECT_TRUE(b.crosses(b.arcs[0], 0));
  EXPECT_FALSE(b.crosses(b.arcs[0], 1));
  EXPECT_TRUE(b.crosses(b.arcs[1], 1));
  EXPECT_EQ(b.cuts[1].camera, 1u);
  EXPECT_EQ(b.name_if_several(1), "yard");
  EXPECT_EQ(example().name_if_several(0), "");
}

TEST(cut, keeps_the_reason_why_there_is_no_bottleneck) {
  CutFile a = example();
  a.bottleneck = false;
  a.arcs.clear();
  a.reason = "the sides are one open space";
  const CutFile b = read(cut_text(a));
  EXPECT_FALSE(b.bottleneck);
  EXPECT_EQ(b.reason, a.reason);
}

std::string repeated(const std::string& line, uint32_t times) {
  std::string all;
  for (uint32_t k = 0; k < times; ++k) all += line;
  return all;
}

// What cuts and networks of patches have in common [patch_lines.h] is tested here alone.
TEST(cut, says_what_is_wrong_and_where) {
  const std::string first = "c tdpt cut 4\n";
  const std::string head = first + "c scene aa\nc grid 0 0 0 0.5\nc bottleneck yes\ns 1 0.1\n";
  const std::string nodes =
      "n 3 0 0 0 0 0 9 0 0 0 0 1 0\nf 3 0\nn 4 1 0 0 0 0 9 0 0 0 0 1 0\nf 4 2\n";
  const std::string camera = "c camera 0 0 0 0 0 -1 0 1 0 0.9 1.5 all yard\n";
  EXPECT_NO_THROW(read(head + nodes + "a 3 4 1\ne 2 1\n"));
  testing::expect_refused(
      {
          {"p max 3 4\n", "", "is no cut file"},
          {"", "", "is no cut file"},
          {"c tdpt cut 5\n", "line 1", "version 5"},
          {"c tdpt cut 3\n", "line 1", "version 3"},
          {"c tdpt cut\n", "line 1", "no version"},
          {head + "x\n", "line 6", "'x'"},
          // Cuts
          {first + "s -1\n", "line 2", "a negative cut"},
          {first + "s nan\n", "line 2", "'nan'"},
          {first + "s 1 2 3\n", "line 2", "from 1 to 1"},
          {first + camera + camera + "s 1 0.1 2 1\n", "line 4", "the end of the line"},
          {first + camera + camera + "s 1 0.1 3\n", "line 4", "from 1 to 2"},
          {head + "s 2 -1\n", "line 6", "a negative conductance"},
          {head + nodes + "s 2 0\n", "line 10", "behind a node"},
          {first + repeated("s 1 0.1\n", kMostCuts + 1), "line 66", "more than 64"},
          // Comments
          {first + repeated(camera, kMostCameras + 1), "line 66", "more than 64"},
          {head + "c camera 1 2 3\n" + nodes, "line 6", kViewpointExpected},
          {head + "c scene\n", "line 6", "hash of the scene"},
          {head + "c grid 0 0 0 1\n", "line 6", "a second grid"},
          {first + "c grid 0 0 0 0\n", "line 2", "a cell without size"},
          {first + "c bottleneck maybe\n", "line 2", "'maybe'"},
          // Nodes
          {head + "n 0 0\n", "line 6", "'0' as node"},
          {head + "n 1.5 0\n", "line 6", "'1.5'"},
          {head + "n 3 q\n", "line 6", "'q'"},
          {head + "n 3 01\n", "line 6", "'01'"},
          {head + "n 3\n", "line 6", "nothing as sides"},
          {head + "n 3 0\n", "line 6", "without geometry"},
          {head + "n 3 0 99\n", "line 6", "'99' as level"},
          {head + "n 3 0 0 0 0 0 -1\n", "line 6", "a negative number of samples"},
          {head + "n 3 0 0 0 0 0 9 0 0 0 0 0 0\n", "line 6", "a normal of another length"},
          {head + nodes + nodes, "line 10", "node 3 again"},
          {head + "n 3 0 0 0 0 0 9 0 0 0 0 1 0\ne 1 0\n", "", "node 3 has no faces"},
          // Bins of the sky
          {head + "k 3 0\n", "line 6", "without geometry"},
          {head + "k 3 0 80 1\n", "line 6", "'80'"},
          {head + "k 3 0 1 -1\n", "line 6", "a negative number of samples"},
          {head + "k 3 0 1 1\nk 4 1 1 1\n", "line 7", "bin 1 of the sky again"},
          {head + "k 3 0 1 1\nf 3 1\n", "line 7", "none of the sky"},
          // Faces and arcs
          {head + nodes + "f 3\n", "line 10", "nothing as face"},
          {head + nodes + "f 3 -1\n", "line 10", "'-1'"},
          {head + nodes + "f 7 1\n", "line 10", "node 7"},
          {head + nodes + "a 4 3 1\n", "line 10", "crosses no cut"},
          {head + nodes + "a 3 4 0\n", "line 10", "a capacity of 0"},
          // What is missing, or behind the end
          {head + nodes + "e 2 0\n", "", "without arcs, cut 1"},
          {head + nodes + "a 3 4 1\n", "", "is cut short: no 'e' line"},
          {head + nodes + "a 3 4 1\ne 2 1", "", "is cut short: its last line"},
          {head + nodes + "a 3 4 1\ne 2 2\n", "line 11", "2 nodes and 1 arcs"},
          {head + nodes + "e 2 0\na 3 4 1\n", "line 11", "behind the 'e' line"},
          {first + "e 0 0\n", "", "no 's' line"},
          {first + "s 0 0\ne 0 0\n", "", "no 'c bottleneck' line"},
          {first + "s 0 0\nc bottleneck no\ne 0 0\n", "", "no 'c scene' line"},
          {first + "s 0 0\nc bottleneck no\nc scene a\ne 0 0\n", "", "no 'c grid' line"},
      },
      read);
}

}  // namespace tdpt::cut_test
