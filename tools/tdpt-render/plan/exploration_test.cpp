// What a first look finds: the light that arrives from each kind of light, and what a limit of
// depth leaves out. Of portals: portal_ways_test.cpp.
#include "tools/tdpt-render/plan/exploration.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "tools/tdpt-render/run/report.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sky.h"

namespace tdpt::exploration_test {

constexpr double kEnd = 4.09;  // the far room's wall [m]

Lights::KindProbabilities arriving(const Scene& scene, const std::vector<Portal>& portals = {}) {
  Vista vista(scene, scene.camera(""), 32, 24, portals);
  const Lights::KindProbabilities plain = vista.openings.selection.shares(),
                                  found = explore(vista, scene.camera(""), portals, kMaxDepth, 1)
                                              .lights;
  EXPECT_NEAR(found.surfaces + found.lamps + found.parallel + found.sky, 1, 1e-12);
  EXPECT_GE(found.sky, 0.1 * plain.sky * (1 - 1e-12));
  EXPECT_GE(found.surfaces, 0.1 * plain.surfaces * (1 - 1e-12));
  return found;
}

TEST(arrival, of_a_sky_round_a_closed_house_is_nothing) {
  const Scene scene = under(diffuse_rooms(), one_colour_sky({2, 3, 4}));
  const Vista vista(scene, scene.camera(""), 32, 24, {});
  EXPECT_GT(vista.openings.selection.shares().sky, 0.5);  // by power
  EXPECT_NEAR(arriving(scene).sky, 0.1 * vista.openings.selection.shares().sky, 1e-12);
}

TEST(arrival, of_a_sky_that_comes_in_is_more) {
  const Scene scene = under(open_end(diffuse_rooms(), kEnd), one_colour_sky({2, 3, 4}));
  EXPECT_GT(arriving(scene).sky, 0.3);
  const Portal end = rectangle({4.1, 0.1, -0.9}, {0, 0, 1.8}, {0, 1.8, 0});
  EXPECT_NEAR(arriving(scene, {end}).sky, arriving(scene).sky, 0.2);
  // Next events look through the portal as drawn, even if it faces the wrong way.
  Portal turned = end;
  for (auto& t : turned.triangles) std::swap(t[1], t[2]);
  EXPECT_NEAR(arriving(scene, {turned}).sky, arriving(scene).sky, 0.2);
}

TEST(arrival, is_the_same_again_and_the_suns_without_lamps) {
  const Scene lit = under(open_end(diffuse_rooms(), kEnd), one_colour_sky({2, 3, 4}));
  EXPECT_EQ(arriving(lit), arriving(lit));
  const Scene scene =
      under(without_lamps(open_end(diffuse_rooms(), kEnd)), one_colour_sky({2, 3, 4}));
  EXPECT_NEAR(arriving(scene).sky, 1, 1e-12);
}

// In the furnace of albedo 1/2 paths of up to k edges carry a share of 1 - 2^-k of the light.
Truncation in_the_furnace(int depth) {
  const Scene scene = read_gltf(furnace_path());
  Vista vista(scene, scene.camera(""), 16, 16, {});
  return explore(vista, scene.camera(""), {}, depth, 7).beyond.value();
}

TEST(truncation, share_of_the_furnace_is_known) {
  for (const int depth : {1, 3, 5}) {
    const Truncation beyond = in_the_furnace(depth);
    EXPECT_EQ(beyond.depth, depth);
    EXPECT_LT(beyond.error, 0.02);
    EXPECT_NEAR(beyond.share, std::pow(0.5, depth), 5 * beyond.error);
    // Twin: paths one edge longer are counted as within.
    EXPECT_GT(std::abs(beyond.share - std::pow(0.5, depth + 1)), 5 * beyond.error);
  }
}

TEST(truncation, is_written_with_as_many_digits_as_are_known) {
  const auto says = [](const Truncation& beyond, const char* words) {
    return sentence(beyond).find(words) != std::string::npos;
  };
  EXPECT_EQ(sentence({6, 0.2512, 0.01}), "--max-depth 6 leaves out about 25 % of the light");
  EXPECT_TRUE(says({12, 0.0363, 0.001}, "about 3.6 %"));
  EXPECT_TRUE(says({6, 0.02, 0.01}, "at most about 4 %"));
  EXPECT_TRUE(says({6, 0.0001, 0.0001}, "less than 0.1 %"));
  EXPECT_TRUE(says({2, 1, 0}, "all of the light"));
}

RenderResult rendered(int max_depth, float albedo) {
  Scene scene = read_gltf(furnace_path());
  for (Material& m : scene.materials) m.base_color = Rgb(albedo);
  const Vista vista(scene, scene.camera(""), 4, 4, {});
  Job settings;
  settings.limits.spp = albedo < 1 ? 64 : 1;
  settings.max_depth = max_depth;
  return render(vista, pt, settings);
}

TEST(length, of_paths_is_counted_by_octaves) {
  const RenderResult r = rendered(kMaxDepth, 0.5f);
  EXPECT_EQ(length_sentence({}, r), "");
  const double all = std::accumulate(r.tally.by_length.begin(), r.tally.by_length.end(), 0.0);
  // 1, 2, 3 to 4, 5 to 8 edges.
  for (const auto& [octave, share] : {std::pair{0, 0.5}, {1, 0.25}, {2, 0.1875}, {3, 0.05859375}})
    EXPECT_NEAR(r.tally.by_length[static_cast<size_t>(octave)] / all, share, 0.02) << octave;
}

TEST(length, where_no_walk_ends_the_hard_stop_is_reported) {
  EXPECT_EQ(length_sentence({}, rendered(kMaxDepth, 1)),
            "paths of 513 to 1024 edges hold 50 % of the light; what longer ones hold is left out");
}

}  // namespace tdpt::exploration_test
