#include "libcommon/formats/cut.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "libcommon/base/error.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/math/rng.h"

namespace tdpt::cut_test {

std::string temporary(const std::string& text) {
  const std::string path = std::filesystem::temp_directory_path() /
                           ("tdpt_cut_test." + std::to_string(::getpid()) + ".cut");
  std::ofstream(path, std::ios::binary) << text;  // not synchronised to disk: there are many
  return path;
}

/// The reader's error for `text`, without the path.
std::string complaint(const std::string& text) {
  const std::string path = temporary(text);
  std::string what = "(accepted)";
  try {
    read_cut(path);
  } catch (const InputError& e) {
    what = std::string(e.what()).substr(path.size() + 1);
  }
  std::filesystem::remove(path);
  return what;
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
  const CutFile a = example();
  const std::string path = temporary(cut_text(a));
  const CutFile b = read_cut(path);
  std::filesystem::remove(path);
  EXPECT_EQ(cut_text(b), cut_text(a));
  ASSERT_EQ(b.patches.size(), 2u);
  EXPECT_EQ(b.patches[1].faces, a.patches[1].faces);
  EXPECT_EQ(b.patches[0].cell, a.patches[0].cell);
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

TEST(cut, reads_back_a_sky) {
  CutFile a = example();
  Patch sky{};
  sky.node = 11;
  sky.samples = 40;
  sky.sky = 3;
  a.patches.push_back(sky);
  a.sides.push_back(0);
  a.arcs.push_back({2, 1, 0.5});
  const std::string path = temporary(cut_text(a));
  const CutFile b = read_cut(path);
  std::filesystem::remove(path);
  EXPECT_EQ(cut_text(b), cut_text(a));
  ASSERT_EQ(b.patches.size(), 3u);
  EXPECT_EQ(b.patches[2].sky, 3);
  EXPECT_EQ(b.patches[2].samples, 40);
  EXPECT_TRUE(b.patches[2].faces.empty());
  EXPECT_EQ(b.sides[2], 0u);
}

// Cuts need not be nested: each patch has its side of each.
TEST(cut, reads_back_cuts_of_several_cameras) {
  CutFile a = example();
  a.cameras.push_back("0 0 0 0 0 -1 0 1 0 0.9 1.5 all yard");
  a.light = {{0.5, {0.25, 0}}, {0, {1, 2}}};
  a.cuts = {{2.75, 0.015, 0}, {1, 0.02, 1}, {3, 0.5, 0}};
  a.sides = {0b010, 0b101};
  a.arcs.push_back({1, 0, 0.5});
  const std::string path = temporary(cut_text(a));
  const CutFile b = read_cut(path);
  std::filesystem::remove(path);
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

TEST(cut, says_what_is_wrong_with_several_cameras) {
  const std::string camera = "c camera 0 0 0 0 0 -1 0 1 0 0.9 1.5 all yard\n";
  EXPECT_EQ(complaint("c tdpt cut 4\n" + camera + camera + "s 1 0.1 2 1\n"),
            "line 4: '1' found, expected the end of the line");
  EXPECT_EQ(complaint("c tdpt cut 4\n" + camera + camera + "s 1 0.1 3\n"),
            "line 4: '3' as camera of the cut, expected a whole number from 1 to 2");
  std::string many = "c tdpt cut 4\n";
  for (uint32_t k = 0; k <= kMostCameras; ++k) many += camera;
  EXPECT_EQ(complaint(many), "line 66: one camera more than 64, expected no more");
}

TEST(cut, keeps_the_reason_why_there_is_no_bottleneck) {
  CutFile a = example();
  a.bottleneck = false;
  a.arcs.clear();
  a.reason = "the sides are one open space";
  const std::string path = temporary(cut_text(a));
  const CutFile b = read_cut(path);
  std::filesystem::remove(path);
  EXPECT_FALSE(b.bottleneck);
  EXPECT_EQ(b.reason, a.reason);
}

const std::string kHead =
    "c tdpt cut 4\nc scene aa\nc grid 0 0 0 0.5\nc bottleneck yes\ns 1 0.1\n";  // lines 1-5

TEST(cut, says_what_is_wrong_and_where) {
  const std::string head = kHead;
  const std::string nodes =
      "n 3 0 0 0 0 0 9 0 0 0 0 1 0\nf 3 0\nn 4 1 0 0 0 0 9 0 0 0 0 1 0\nf 4 2\n";
  EXPECT_EQ(complaint(head + nodes + "a 3 4 1\ne 2 1\n"), "(accepted)");
  EXPECT_EQ(complaint(head + "c camera 1 2 3\n" + nodes),
            std::string("line 6: '1 2 3' as camera, ") + kViewpointExpected);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"p max 3 4\n", " is no cut file, expected it to start with 'c tdpt cut 4'"},
      {"", " is no cut file, expected it to start with 'c tdpt cut 4'"},
      {"c tdpt cut 5\n",
       "line 1: this file has version 5 of the format; this program reads version 4"},
      {"c tdpt cut 3\n",
       "line 1: this file has version 3 of the format; this program reads version 4"},
      {"c tdpt cut\n",
       "line 1: the file says no version of its format; this program reads version 4"},
      {head + nodes + "s 2 0\n", "line 10: an 's' line behind a node, expected it before"},
      {head + "s 2 -1\n", "line 6: a negative conductance, expected 0 or more"},
      {head + "s 2 0\nn 3 00 0 0 0 0 9 0 0 0 0 1 0\nf 3 0\nn 4 10 0 0 0 0 9 0 0 0 0 1 0\nf 4 2\na "
              "3 4 1\ne 2 1\n",
       " a bottleneck without arcs, cut 2, expected pivot pairs"},
      {"c tdpt cut 4\ns -1\n", "line 2: a negative cut, expected a value of 0 or more"},
      {"c tdpt cut 4\ns nan\n", "line 2: 'nan' as value of the cut, expected a finite number"},
      {"c tdpt cut 4\ns 1 2 3\n",
       "line 2: '3' as camera of the cut, expected a whole number from 1 to 1"},
      {head + "x\n", "line 6: 'x' at the start of the line, expected one of c, s, n, k, f, a, e"},
      {head + "c scene\n", "line 6: nothing as hash of the scene, expected one"},
      {head + "c grid 0 0 0 1\n", "line 6: a second grid, expected one"},
      {"c tdpt cut 4\nc grid 0 0 0 0\n", "line 2: a cell without size, expected a side above 0"},
      {"c tdpt cut 4\nc bottleneck maybe\n", "line 2: 'maybe' as bottleneck, expected yes or no"},
      {head + "n 0 0\n", "line 6: '0' as node, expected a whole number from 1 to 4294967295"},
      {head + "n 1.5 0\n", "line 6: '1.5' as node, expected a whole number from 1 to 4294967295"},
      {head + "n 3 q\n", "line 6: 'q' as sides of the cuts, expected 1 of the digits 0 and 1"},
      {head + "n 3 2\n", "line 6: '2' as sides of the cuts, expected 1 of the digits 0 and 1"},
      {head + "n 3 01\n", "line 6: '01' as sides of the cuts, expected 1 of the digits 0 and 1"},
      {head + "n 3\n", "line 6: nothing as sides of the cuts, expected 1 of the digits 0 and 1"},
      {head + "n 3 0\n",
       "line 6: a node without geometry, expected the cut of a network made by ffgraph"},
      {head + "n 3 0 99\n",
       "line 6: '99' as level of the patch, expected a whole number from 0 to 10"},
      {head + "n 3 0 0 0 0 0 -1\n", "line 6: a negative number of samples, expected 0 or more"},
      {head + "n 3 0 0 0 0 0 9 0 0 0 0 0 0\n",
       "line 6: a normal of another length, expected length 1"},
      {head + nodes + nodes, "line 10: node 3 again, expected each node once"},
      {head + nodes + "f 3\n", "line 10: nothing as face, expected at least one"},
      {head + nodes + "f 3 -1\n",
       "line 10: '-1' as face, expected a whole number from 0 to 4294967295"},
      {head + nodes + "f 7 1\n", "line 10: node 7 as node of a face, expected a patch named above"},
      {head + nodes + "a 4 3 1\n",
       "line 10: an arc that crosses no cut, expected one from a light's side to a camera's"},
      {head + nodes + "a 3 4 0\n", "line 10: a capacity of 0 or less, expected one above 0"},
      {head + nodes + "e 2 0\n", " a bottleneck without arcs, cut 1, expected pivot pairs"},
      {head + "n 3 0 0 0 0 0 9 0 0 0 0 1 0\ne 1 0\n",
       " node 3 has no faces, expected at least one"},
      {head + nodes + "a 3 4 1\n", " is cut short: no 'e' line, expected it at the end"},
      {head + nodes + "a 3 4 1\ne 2 2\n",
       "line 11: 2 nodes and 1 arcs above, expected the 2 and 2 of this line"},
      {head + nodes + "e 2 0\na 3 4 1\n",
       "line 11: a line behind the 'e' line, expected the end of the file"},
      {"c tdpt cut 4\ne 0 0\n", " no 's' line, expected the value of the cut"},
      {"c tdpt cut 4\ns 0 0\ne 0 0\n", " no 'c bottleneck' line, expected yes or no"},
      {"c tdpt cut 4\ns 0 0\nc bottleneck no\ne 0 0\n",
       " no 'c scene' line, expected the hash of the scene"},
      {"c tdpt cut 4\ns 0 0\nc bottleneck no\nc scene a\ne 0 0\n",
       " no 'c grid' line, expected the grid of the patches"},
  };
  for (const auto& [text, expected] : cases) EXPECT_EQ(complaint(text), expected) << text;
  std::string many = "c tdpt cut 4\n";
  for (uint32_t c = 0; c <= kMostCuts; ++c) many += "s 1 0.1\n";
  EXPECT_EQ(complaint(many), "line 66: one cut more than 64, expected no more");
}

TEST(cut, says_what_is_wrong_with_a_sky_and_where) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {kHead + "k 3 0\n",
       "line 6: a node without geometry, expected the cut of a network made by ffgraph"},
      {kHead + "k 3 0 80 1\n",
       "line 6: '80' as bin of the sky, expected a whole number from 0 to 79"},
      {kHead + "k 3 0 1 -1\n", "line 6: a negative number of samples, expected 0 or more"},
      {kHead + "k 3 0 1 1\nk 4 1 1 1\n", "line 7: bin 1 of the sky again, expected each once"},
      {kHead + "k 3 0 1 1\nk 3 1 2 1\n", "line 7: node 3 again, expected each node once"},
      {kHead + "k 3 0 1 1\nf 3 1\n", "line 7: faces of node 3, expected none of the sky"},
  };
  for (const auto& [text, expected] : cases) EXPECT_EQ(complaint(text), expected) << text;
}

// Wherever a file ends early, even in the middle of a number; without a bottleneck it has no arcs.
TEST(cut, is_refused_when_cut_short) {
  CutFile closed = example();
  closed.bottleneck = false;
  closed.arcs.clear();
  for (const CutFile& file : {example(), closed}) {
    const std::string whole = cut_text(file);
    EXPECT_EQ(complaint(whole.substr(0, whole.size() - 1)),
              " is cut short: its last line has no end");
    for (size_t n = 0; n < whole.size(); ++n)
      ASSERT_NE(complaint(whole.substr(0, n)), "(accepted)") << whole.substr(0, n);
  }
}

// However a file is damaged, it is read or refused with a message; run under sanitizers, too.
TEST(cut, damaged_files_are_read_or_refused) {
  const std::string whole = cut_text(example());
  Rng rng(5, 0, 0);
  int refused = 0;
  for (int k = 0; k < 300; ++k) {
    std::string text = whole;
    for (uint32_t n = 1 + rng.below(4); n > 0; --n) {
      const uint32_t at = rng.below(static_cast<uint32_t>(text.size()));
      switch (rng.below(3)) {
        case 0:
          text[at] = static_cast<char>(rng.below(256));
          break;
        case 1:
          text.erase(at, 1 + rng.below(9));
          break;
        default:
          text.insert(at, std::to_string(rng.bits()));
          break;
      }
    }
    if (rng.below(4) == 0) text.resize(rng.below(static_cast<uint32_t>(text.size())));
    refused += complaint(text) != "(accepted)";
  }
  EXPECT_GT(refused, 150);
}

}  // namespace tdpt::cut_test
