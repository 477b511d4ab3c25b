// What arrives of each kind of light, and what the scout tells where light walks of a run are
// directed and a candidate's are not.
#include "tools/tdpt-render/arrival.h"

#include <gtest/gtest.h>

#include "tools/tdpt-render/path/test_oracle.h"
#include "tools/tdpt-render/scout.h"
#include "tools/tdpt-render/test_sky.h"

namespace tdpt {
namespace {

constexpr double kEnd = 4.09;  // the far room's wall [m]

Lights::Shares arriving(const Scene& scene, const std::vector<Portal>& portals = {}) {
  const World world(scene, scene.camera(""), 32, 24, portals);
  const Lights::Shares plain = world.lights.shares(), found = arriving_shares(world, {});
  EXPECT_NEAR(found.surfaces + found.lamps + found.parallel + found.sky, 1, 1e-12);
  EXPECT_GE(found.sky, 0.1 * plain.sky * (1 - 1e-12));
  EXPECT_GE(found.surfaces, 0.1 * plain.surfaces * (1 - 1e-12));
  return found;
}

TEST(arrival, of_a_sky_round_a_closed_house_is_nothing) {
  const Scene scene = under(diffuse_rooms(), one_colour_sky({2, 3, 4}));
  const World world(scene, scene.camera(""), 32, 24, {});
  EXPECT_GT(world.lights.shares().sky, 0.5);  // by power
  EXPECT_NEAR(arriving(scene).sky, 0.1 * world.lights.shares().sky, 1e-12);
}

TEST(arrival, of_a_sky_that_comes_in_is_more) {
  const Scene scene = under(open_end(diffuse_rooms(), kEnd), one_colour_sky({2, 3, 4}));
  EXPECT_GT(arriving(scene).sky, 0.3);
  const Portal end = rectangle({4.1, 0.1, -0.9}, {0, 0, 1.8}, {0, 1.8, 0});
  EXPECT_NEAR(arriving(scene, {end}).sky, arriving(scene).sky, 0.2);
}

TEST(arrival, is_the_same_again_and_the_suns_without_lamps) {
  const Scene lit = under(open_end(diffuse_rooms(), kEnd), one_colour_sky({2, 3, 4}));
  EXPECT_EQ(arriving(lit), arriving(lit));
  const Scene scene =
      under(without_lamps(open_end(diffuse_rooms(), kEnd)), one_colour_sky({2, 3, 4}));
  EXPECT_NEAR(arriving(scene).sky, 1, 1e-12);
}

// Light walks find what camera walks miss here: told by the run's own weights, bdpt has 0.38 and
// 0.45 of the error of nee, both with camera walks directed alike. With its own weights for walks
// that it would seldom make it had 0.93 and 1.01, and in a room with one window 4000.
TEST(scout_under_a_sky, directed_light_walks_do_not_stand_for_those_that_are_not) {
  const Scene scene =
      under(without_lamps(open_end(diffuse_rooms(), kEnd)), one_colour_sky({2, 3, 4}));
  for (const bool in_the_end_too : {false, true}) {
    std::vector<Portal> portals = two_crossing_portals();
    if (in_the_end_too) portals.push_back(rectangle({4.1, 0.1, -0.9}, {0, 0, 1.8}, {0, 1.8, 0}));
    const World world(scene, scene.camera(""), 32, 24, portals);
    const std::vector<Candidate> candidates = auto_candidates(world);
    Scout scout(world, candidates, {});
    Film film(32, 24, world.lights.power());
    scout.draw(2048, film);
    double with_light_walks = 0, without = 0;
    for (const Prospect& p : scout.prospects()) {
      if (p.integrator == "bdpt 0 0.4") with_light_walks = p.relmse;
      if (p.integrator == "nee 0 0.4") without = p.relmse;
    }
    ASSERT_GT(without, 0);
    ASSERT_GT(with_light_walks, 0);
    EXPECT_LT(with_light_walks, 0.65 * without);
  }
}

}  // namespace
}  // namespace tdpt
