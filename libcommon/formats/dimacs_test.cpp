#include "libcommon/formats/dimacs.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "libcommon/base/error.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/math/rng.h"

namespace tdpt::dimacs_test {

std::string temporary(const std::string& text) {
  const std::string path = std::filesystem::temp_directory_path() /
                           ("tdpt_dimacs_test." + std::to_string(::getpid()) + ".max");
  std::ofstream(path, std::ios::binary) << text;  // not synchronised to disk: there are many
  return path;
}

DimacsFile read_text(const std::string& text) {
  const std::string path = temporary(text);
  DimacsFile file;
  try {
    file = read_dimacs(path);
  } catch (...) {
    std::filesystem::remove(path);
    throw;
  }
  std::filesystem::remove(path);
  return file;
}

/// The reader's error for `text`, without the path.
std::string complaint(const std::string& text) {
  try {
    read_text(text);
  } catch (const InputError& e) {
    const std::string what = e.what();
    return what.substr(what.find(".max:") + 5);
  }
  return "(accepted)";
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
  const DimacsFile a = example();
  const DimacsFile b = read_text(dimacs_text(a));
  EXPECT_EQ(dimacs_text(b), dimacs_text(a));
  ASSERT_EQ(b.patches.size(), 2u);
  EXPECT_EQ(b.scale, 1000);
  EXPECT_EQ(b.cameras, a.cameras);
  ASSERT_EQ(b.walks.size(), 2u);
  EXPECT_EQ(b.walks[1].begun, 90);
  EXPECT_EQ(b.walks[0].light, 210);
  EXPECT_EQ(b.walks[1].camera, std::vector<double>{160});
  EXPECT_EQ(b.network.arcs.size(), 4u);
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
  const DimacsFile a = of_two_cameras(), b = read_text(dimacs_text(a));
  EXPECT_EQ(dimacs_text(b), dimacs_text(a));
  EXPECT_EQ(b.number_of_cameras(), 2u);
  EXPECT_EQ(b.cameras, a.cameras);
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

std::string complaint_without(const std::string& line) {
  std::string text = dimacs_text(of_two_cameras());
  const size_t at = text.find(line);
  EXPECT_NE(at, text.npos) << line;
  return complaint(text.erase(at, line.size()));
}

TEST(dimacs, says_what_is_wrong_with_several_cameras) {
  EXPECT_EQ(complaint_without("c sink 5\n"),
            " 2 cameras and 0 more sinks, expected one for each but the first");
  DimacsFile f = of_two_cameras();
  f.more_sinks = {3};
  EXPECT_EQ(complaint(dimacs_text(f)),
            " node 4 as sink of camera 2, expected 5: they are the last");
  f = of_two_cameras();
  f.network.arcs.push_back({4, 2, 1});
  EXPECT_EQ(complaint(dimacs_text(f)), " an arc from node 5, a sink, expected none");
  f = of_two_cameras();
  f.walks[0].camera.push_back(3);
  EXPECT_NE(complaint(dimacs_text(f)).find("'3' found, expected the end of the line"),
            std::string::npos);
}

TEST(dimacs, reads_back_a_sky) {
  DimacsFile a = example();
  Patch sky{};
  sky.node = 5;
  sky.samples = 77.5;
  sky.sky = 79;
  a.patches.push_back(sky);
  a.walks.push_back({9, 0, {0}});
  a.network.nodes = 5;
  a.network.arcs.push_back({4, 2, 60});
  const DimacsFile b = read_text(dimacs_text(a));
  EXPECT_EQ(dimacs_text(b), dimacs_text(a));
  ASSERT_EQ(b.patches.size(), 3u);
  EXPECT_TRUE(b.patches[2].is_sky());
  EXPECT_FALSE(b.patches[1].is_sky());
  EXPECT_EQ(b.patches[2].sky, 79);
  EXPECT_EQ(b.patches[2].samples, 77.5);
  EXPECT_EQ(b.walks[2].begun, 9);
}

TEST(dimacs, plain_problems_of_others_are_read) {
  const DimacsFile f = read_text(
      "c a problem from a book\nc grid of streets\n\np max 4 5\r\nn 1 s\nn 4 t\na 1 2 4\na 1 3 2\n"
      "a 2 3 3\na 3 4 5\na 2 2 9\n");
  EXPECT_FALSE(f.has_patches);
  EXPECT_EQ(f.network.nodes, 4u);
  EXPECT_EQ(f.network.arcs.size(), 5u);
}

TEST(dimacs, comments_of_others_are_no_version) {
  for (const char* comment : {"c tdpt\n", "c tdpt max\n", "c tdpt max flow\n", "c tdpt min 2\n"})
    EXPECT_FALSE(
        read_text(comment + std::string("p max 2 1\nn 1 s\nn 2 t\na 1 2 4\n")).has_patches);
}

// A problem whose first line is line 1, or line 4 after `kOurs`.
const std::string kProblem = "p max 4 2\nn 1 s\nn 4 t\n";
const std::string kArcs = "a 1 2 4\na 2 4 4\n";
const std::string kOurs = "c tdpt max 1\nc scene aa\nc grid 0 0 0 1\n";

TEST(dimacs, says_what_is_wrong_and_where) {
  const std::string p = kProblem, arcs = kArcs;
  EXPECT_EQ(complaint(kOurs + "c camera\n" + p + arcs),
            std::string("line 4: nothing as camera, ") + kViewpointExpected);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {p + arcs, "(accepted)"},
      {"", " no 'p max' line, expected a DIMACS maximum-flow problem"},
      {"x\n", "line 1: 'x' at the start of the line, expected one of c, p, n, a"},
      {p + arcs + "c from " + std::string(5000, 'x') + std::string(1, '\0') + "\n",
       " is a binary file, expected a DIMACS maximum-flow problem such as ffgraph writes"},
      {"c tdpt max 2\n" + p + arcs,
       "line 1: this file has version 2 of the format; this program reads version 1"},
      {p + arcs + "c  tdpt max 10 \r\n",
       "line 6: this file has version 10 of the format; this program reads version 1"},
      {p + "p max 4 2\n", "line 4: a second 'p' line, expected one"},
      {"p min 4 2\n", "line 1: 'min' as problem, expected max"},
      {"p max 1 2\n",
       "line 1: '1' as number of nodes, expected a whole number from 2 to 2147483647"},
      {"p max 2147483647 0\n",
       "line 1: 2147483647 nodes in a file of 19 bytes, expected at most 1048595"},
      {"p max 4 -1\n",
       "line 1: '-1' as number of arcs, expected a whole number from 0 to 2147483647"},
      {"p max 4 2 7\n", "line 1: '7' found, expected the end of the line"},
      {"n 1 s\n", "line 1: a line that needs the numbers of a 'p max' line, expected it above"},
      {p + "n 2 s\n", "line 4: a second source, expected one"},
      {p + "n 2 t\n", "line 4: a second sink, expected one"},
      {"p max 4 0\nn 2 s\nn 2 t\n", "line 3: the same node as source and sink, expected two nodes"},
      {p + "n 2 x\n", "line 4: 'x' as terminal, expected s or t"},
      {p + "a 0 2 1\n", "line 4: '0' as tail of an arc, expected a whole number from 1 to 4"},
      {p + "a 1 5 1\n", "line 4: '5' as head of an arc, expected a whole number from 1 to 4"},
      {p + "a 1 2 0.5\n",
       "line 4: '0.5' as capacity, expected a whole number from 0 to 9223372036854775807"},
      {p + "a 1 2 -3\n",
       "line 4: '-3' as capacity, expected a whole number from 0 to 9223372036854775807"},
      {p + "a 1 2 9223372036854775808\n",
       "line 4: '9223372036854775808' as capacity, expected a whole number from 0 to "
       "9223372036854775807"},
      {p + "a 1 2\n",
       "line 4: nothing as capacity, expected a whole number from 0 to 9223372036854775807"},
      {p + "a 1 2 2000000000000000000\na 2 4 2000000000000000000\n",
       "line 5: capacities add up beyond 2305843009213693951, expected a smaller sum"},
      {p + arcs + "a 1 4 1\n", "line 6: one arc more than the 2 of the 'p' line"},
      {p + "a 1 2 4\n", " 1 arcs, expected the 2 of the 'p' line"},
      {"p max 4 0\nn 4 t\n", " no source, expected a line 'n NODE s'"},
      {"p max 4 0\nn 4 s\n", " no sink, expected a line 'n NODE t'"},
  };
  for (const auto& [text, expected] : cases) EXPECT_EQ(complaint(text), expected) << text;
}

TEST(dimacs, says_what_is_wrong_with_patches_and_where) {
  const std::string p = kProblem, arcs = kArcs, ours = kOurs;
  const std::string geometry = " 0 0 0 0 9 0 0 0 0 1 0\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {ours + "c patch 2" + geometry + "c faces 2 0\nc patch 3" + geometry + "c faces 3 4 6\n" + p +
           arcs,
       "(accepted)"},
      // Walks for one patch only: the other has none.
      {ours + "c patch 2" + geometry + "c faces 2 0\nc walks 2 1 2 3\nc patch 3" + geometry +
           "c faces 3 4 6\n" + p + arcs,
       "(accepted)"},
      {ours + "c patch 2" + geometry + "c walks 3 1 2 3\n",
       "line 5: node 3 as node of walks, expected a patch named above"},
      {ours + "c patch 2" + geometry + "c walks 2 1 -2 3\n",
       "line 5: a negative number of walks, expected 0 or more"},
      {"c tdpt max 1\nc scale 0\n", "line 2: a scale of 0 or less, expected one above 0"},
      {"c tdpt max 1\nc scene\n", "line 2: nothing as hash of the scene, expected one"},
      {"c tdpt max 1\nc grid 0 0 0 -1\n", "line 2: a cell without size, expected a side above 0"},
      {ours + "c patch 2" + geometry + "c patch 2" + geometry,
       "line 5: node 2 again, expected each node once"},
      {ours + "c faces 2 1\n", "line 4: node 2 as node of a face, expected a patch named above"},
      {"c tdpt max 1\n" + p + arcs, " no 'c scene' line, expected the hash of the scene"},
      {"c tdpt max 1\nc scene a\n" + p + arcs,
       " no 'c grid' line, expected the grid of the patches"},
      {ours + p + arcs, " 0 patches, expected one for each of the 2 inner nodes"},
      {ours + "c patch 2" + geometry + p + arcs, " node 2 has no faces, expected at least one"},
      {ours + "c patch 1" + geometry + "c faces 1 0\n" + p + arcs,
       " patch 1 is no inner node of the network"},
      {ours + "c scale 1e300\nc patch 2" + geometry + "c faces 2 0\n" + p + arcs,
       " samples times the scale add up to 9e+300, expected less than 2.31e+18"},
  };
  for (const auto& [text, expected] : cases) EXPECT_EQ(complaint(text), expected) << text;
}

TEST(dimacs, says_what_is_wrong_with_a_sky_and_where) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {kOurs + "c sky 2 80 1\n",
       "line 4: '80' as bin of the sky, expected a whole number from 0 to 79"},
      {kOurs + "c sky 2 -1 1\n",
       "line 4: '-1' as bin of the sky, expected a whole number from 0 to 79"},
      {kOurs + "c sky 2 7 -1\n", "line 4: a negative number of samples, expected 0 or more"},
      {kOurs + "c sky 2 7 nan\n", "line 4: 'nan' as samples of the bin, expected a finite number"},
      {kOurs + "c sky 2 7 1 5\n", "line 4: '5' found, expected the end of the line"},
      {kOurs + "c sky 2 7 1\nc sky 3 7 1\n", "line 5: bin 7 of the sky again, expected each once"},
      {kOurs + "c sky 2 7 1\nc sky 2 8 1\n", "line 5: node 2 again, expected each node once"},
      {kOurs + "c sky 2 7 1\nc faces 2 4\n", "line 5: faces of node 2, expected none of the sky"},
      {kOurs + "c sky 1 7 1\n" + kProblem + kArcs, " patch 1 is no inner node of the network"},
  };
  for (const auto& [text, expected] : cases) EXPECT_EQ(complaint(text), expected) << text;
}

// Wherever a file of ours ends early, even in the middle of a number.
TEST(dimacs, is_refused_when_cut_short) {
  const std::string whole = dimacs_text(example());
  for (size_t n = 0; n < whole.size(); ++n)
    ASSERT_NE(complaint(whole.substr(0, n)), "(accepted)") << whole.substr(0, n);
  EXPECT_EQ(complaint(whole.substr(0, whole.size() - 1)),
            " is cut short: its last line has no end");
  EXPECT_EQ(complaint("p max 2 1\nn 1 s\nn 2 t\na 1 2 4"), "(accepted)") << "another program's";
}

// However a file is damaged, it is read or refused with a message; run under sanitizers, too.
TEST(dimacs, damaged_files_are_read_or_refused) {
  const std::string whole = dimacs_text(example());
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

}  // namespace tdpt::dimacs_test
