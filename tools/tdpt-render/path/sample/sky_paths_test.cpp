// Compares every path of every technique under a sky with the oracle: x_0 is a direction, P>(x_0)
// and P<(x_0) are per solid angle, and so is the light's end of a portal segment.
#include <gtest/gtest.h>

#include "tools/tdpt-render/plan/candidates.h"
#include "tools/tdpt-render/testing/known_paths.h"
#include "tools/tdpt-render/testing/sky.h"

namespace tdpt::sky_paths_test {

using oracle::Fault;

constexpr double kEnd = 4.09;  // the far room's wall [m]

const Sky::Sun kSun = sun_of({1, 0.12, 0.05}, 0.25 * kDegree, 4);
const Sky::Sun kHaze = sun_of({1, 0.3, -0.2}, 10 * kDegree, 2);

/// The far room has no end wall: the sky shines through it and the hole.
Scene diffuse_under_the_sky() {
  return under(without_lamps(open_end(diffuse_rooms(), kEnd)), uneven_sky({kSun, kHaze}));
}
Scene glossy_under_the_sky() {
  return under(without_lamps(open_end(glossy_rooms(), kEnd)), uneven_sky({kSun, kHaze}));
}
Scene diffuse_with_lamps() {
  return under(open_end(diffuse_rooms(), kEnd), uneven_sky({kHaze}));
}
Scene glossy_with_lamps() {
  return under(open_end(glossy_rooms(), kEnd), one_colour_sky({2, 3, 4}));
}

/// The hole's, the tilted one in the camera's room, and one in the open end.
std::vector<Portal> three_portals() {
  std::vector<Portal> portals = two_crossing_portals();
  portals.push_back(rectangle({4.1, 0.1, -0.9}, {0, 0, 1.8}, {0, 1.8, 0}));
  return portals;
}

class sky_paths : public testing::TestWithParam<const Integrator*> {};

TEST_P(sky_paths, weights_and_values_are_the_oracles) {
  for (const auto& portals : {two_crossing_portals(), three_portals()})
    for (const Scene& scene : {diffuse_under_the_sky(), diffuse_with_lamps()}) {
      const Worst worst = compare(scene, *GetParam(), Fault::none, 6, 96, portals);
      EXPECT_LT(worst.weight, 1e-6);
      EXPECT_LT(worst.power, 2e-6);
      EXPECT_LT(worst.value, 1e-4);
      for (size_t i = 0; i < kTechniques; ++i) {
        if (GetParam()->mixture.has(static_cast<Technique>(i))) {
          EXPECT_GT(worst.sky[i], 15) << kTechniqueNames[i];
        }
      }
    }
}

// A ray aimed at a portal's border may miss it by rounding, as in path_test.cpp.
TEST_P(sky_paths, over_glossy_surfaces_too) {
  for (const Scene& scene : {glossy_under_the_sky(), glossy_with_lamps()}) {
    const Worst worst = compare(scene, *GetParam(), Fault::none, 6, 96, three_portals());
    EXPECT_LT(worst.weight, 1e-4);
    EXPECT_LT(worst.power, 2e-4);
    EXPECT_LE(worst.off, 2);
    EXPECT_LE(worst.short_ones, 5);
    EXPECT_GT(worst.dirac, 10);
  }
}

TEST_P(sky_paths, through_portals_for_both_ways_are_the_oracles) {
  std::vector<Portal> portals = three_portals();
  for (Portal& portal : portals) portal.both_ways = true;
  const Worst worst = compare(diffuse_with_lamps(), *GetParam(), Fault::none, 6, 48, portals);
  EXPECT_LT(worst.weight, 1e-6);
  EXPECT_LT(worst.value, 1e-4);
}

TEST_P(sky_paths, of_walks_without_limit_are_the_oracles) {
  Scene scene = diffuse_with_lamps();
  for (Material& m : scene.materials) m.base_color = Rgb(0.8f);
  const Worst worst = compare(scene, *GetParam(), Fault::none, kMaxDepth, 24, three_portals());
  EXPECT_LE(worst.off, 4);
  if (GetParam() != &pt) {
    EXPECT_GT(worst.longest, 12);
  }
}

INSTANTIATE_TEST_SUITE_P(integrators, sky_paths, testing::ValuesIn(integrators()),
                         [](const auto& integrator) {
                           std::string name = integrator.param->name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// All candidates of auto.
TEST(sky_paths_of_candidates, are_the_oracles) {
  const Scene scene = diffuse_with_lamps();
  const Vista vista(scene, scene.camera(""), 16, 12, three_portals());
  int directed = 0, anywhere = 0;
  for (const Candidate& c : auto_candidates(vista)) {
    const Worst worst = compare(scene, c.integrator, Fault::none, 6, 64, three_portals());
    EXPECT_LT(worst.weight, 1e-6) << c.label;
    EXPECT_LT(worst.value, 1e-4) << c.label;
    directed += c.integrator.mixture.guiding != Guiding{};
    anywhere += c.integrator.mixture.through_windows == 0;
  }
  EXPECT_GT(std::min(directed, anywhere), 1);
}

// Random cases: portals of all places, sizes and directions, overlapping; maps of any size with
// black texels; any suns; any mixtures.
struct Case {
  explicit Case(uint64_t seed) {
    Rng rng(61, 0, seed);
    const auto in = [&](double a, double b) { return a + (b - a) * rng.uniform(); };
    const auto often = [&](double share) { return rng.uniform() < share; };
    for (double n = in(1, 6); n > 1; --n) {
      if (often(0.5)) {
        const double x = in(2, 4.2), y = in(0, 0.5), z = in(-0.9, 0), depth = in(0.2, 1);
        portals.push_back(rectangle({x, y, z}, {0, 0, depth}, {0, in(0.2, 1.5), 0}));
      } else {
        const double x = in(0, 4.3), y = in(0, 1.5), z = in(-1, 0.5), a = in(-1, 1), b = in(-1, 1);
        portals.push_back(rectangle({x, y, z}, {a, b, 0.5}, {b, 0.7, -a}));
      }
      if (often(0.2)) portals.back().triangles.pop_back();
      portals.back().both_ways = often(0.4);
      if (often(0.1)) portals.push_back(portals.back());
    }
    Sky::Map map{static_cast<int>(in(1, 40)), static_cast<int>(in(1, 20)), {}};
    if (often(0.2)) map.width = map.height = 1;
    for (int i = 0; i < map.width * map.height; ++i)
      map.texels.push_back(Rgb(often(0.3) ? 0 : static_cast<float>(std::pow(10, in(-2, 3)))));
    std::vector<Sky::Sun> suns;
    const double y = in(-0.3, 0.5), half_angle = std::pow(10, in(-4, -0.3));
    if (often(0.5)) suns.push_back(sun_of({1, y, 0.2}, half_angle, 3));
    if (often(0.2)) map = {};
    scene = open_end(diffuse_rooms(), kEnd);
    if (often(0.5)) scene = without_lamps(scene);
    scene.sky = std::make_shared<Sky>(map, in(0, 6), suns);
    integrator = kIntegrators[static_cast<size_t>(in(1, 6))];
    if (often(0.5)) integrator.mixture.guiding.chance = {0.7 * in(0, 1), 0.4};
    integrator.mixture.through_windows = often(0.3) ? 0 : in(0, 0.95);
  }
  Scene scene;
  std::vector<Portal> portals;
  Integrator integrator;
};
TEST(sky_paths_at_random, are_the_oracles) {
  int all = 0, from_sky = 0;
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const Case c(seed);
    const Worst worst = compare(c.scene, c.integrator, Fault::none, 6, 8, c.portals);
    EXPECT_LE(worst.off, 2) << seed;  // rays that miss a portal's border by rounding
    all += worst.all;
    for (const int n : worst.sky) from_sky += n;
  }
  EXPECT_GT(all, 2000);
  EXPECT_GT(from_sky, 1000);
}

// As the pilot does.
TEST(sky_paths_under_other_mixtures, weigh_as_the_oracle_says) {
  Mixture often = tdpt_guided.mixture, anywhere = bdpt.mixture, aiming = nee.mixture;
  often.guiding = {{0.9, 0.8}};
  anywhere.through_windows = 0;
  aiming.guiding = {{0, 0.1}};  // less than bright surfaces allow
  const Scene scene = diffuse_with_lamps();
  for (const Integrator* made : {&tdpt_org, &tdpt_guided})
    for (const Mixture& asked : {nee.mixture, anywhere, tdpt_org.mixture, aiming, often}) {
      EXPECT_LE(weighed_as_others(scene, *made, asked, asked, three_portals()), 3) << made->name;
      // Twins: guided a little more often than asked, and looking out.
      for (const bool directed : {true, false}) {
        Mixture told = asked;
        if (directed && told.guiding == Guiding{}) continue;
        if (directed) told.guiding.chance[0] += 0.05, told.guiding.chance[1] += 0.05;
        if (!directed) told.through_windows += 0.05;
        EXPECT_GT(weighed_as_others(scene, *made, asked, told, three_portals()), 10) << made->name;
      }
    }
}

// Besides lamps the sky is one light of several: its share counts as well.
TEST(sky_path_twin, a_density_of_the_skys_directions_off_by_5_percent_is_caught) {
  for (const Scene& scene : {diffuse_under_the_sky(), diffuse_with_lamps(), glossy_with_lamps()})
    for (const Integrator* integrator : {&nee, &bdpt, &tdpt_ref, &tdpt_guided}) {
      const Worst worst = compare(scene, *integrator, Fault::sky_5_percent, 6, 32, three_portals());
      EXPECT_GT(worst.weight, 1e-3) << integrator->name;
      EXPECT_GT(worst.value, 0.04) << integrator->name;
    }
}

TEST(sky_path_twin, what_segments_from_the_sky_have_too_much_is_caught) {
  for (const Fault fault :
       {Fault::sky_segment_distance, Fault::sky_segment_cosine, Fault::portal_density_5_percent})
    for (const Scene& scene : {diffuse_under_the_sky(), glossy_with_lamps()})
      for (const Integrator* integrator : {&tdpt_org, &tdpt_ref, &tdpt_guided}) {
        const Worst worst = compare(scene, *integrator, fault, 6, 16, three_portals());
        EXPECT_GT(worst.weight, 1e-3) << integrator->name;
        EXPECT_GT(worst.value, 0.04) << integrator->name;
      }
}

TEST(sky_path_twin, next_events_through_windows_off_by_5_percent_are_caught) {
  for (const Scene& scene : {diffuse_under_the_sky(), glossy_with_lamps()})
    for (const Integrator* integrator : {&nee, &bdpt, &tdpt_ref, &tdpt_guided}) {
      const Worst worst =
          compare(scene, *integrator, Fault::window_5_percent, 6, 32, three_portals());
      EXPECT_GT(worst.weight, 1e-3) << integrator->name;
      EXPECT_GT(worst.value, 0.02) << integrator->name;
    }
}

TEST(sky_path_twin, an_aim_off_by_5_percent_is_caught) {
  for (const Scene& scene : {diffuse_under_the_sky(), glossy_with_lamps()}) {
    const Worst worst = compare(scene, tdpt_guided, Fault::guide_5_percent, 6, 16, three_portals());
    EXPECT_GT(worst.weight, 1e-3);
    EXPECT_GT(worst.value, 0.04);
  }
}

}  // namespace tdpt::sky_paths_test
