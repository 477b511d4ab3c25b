// What a pilot concludes from pictures: plans, errors, weights, decisions.
#include "tools/tdpt-render/pilot.h"

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "tools/tdpt-render/test_rooms.h"

namespace tdpt {
namespace {

constexpr int kWidth = 96, kHeight = 72;
constexpr size_t kPixels = size_t{kWidth} * kHeight;

// Pictures of a pass whose pixels are `mean` on average: of `rate` of them, at random.
std::vector<Vec3d> pass(double mean, double rate, Rng& rng) {
  std::vector<Vec3d> picture(kPixels);
  for (Vec3d& p : picture)
    if (rng.uniform() < rate) p = Vec3d{1, 1, 1} * (mean / rate);
  return picture;
}

// relMSE of one sample: (1/rate - 1) of the mean squared.
double expected(double rate) {
  return (1 / rate - 1) / 1.01;
}

TEST(plan, small_budgets_have_no_pilot_and_large_ones_a_small_one) {
  EXPECT_EQ(plan_pilot(16, 1 << 20, 4, true).rounds, 0u);
  EXPECT_EQ(plan_pilot(31, 1 << 20, 4, true).rounds, 0u);
  EXPECT_EQ(plan_pilot(1e9, 1 << 20, 1, true).rounds, 0u);
  EXPECT_EQ(plan_pilot(128, 192, 4, true).rounds, 0u);
  for (double spp : {32.0, 40.0, 64.0, 200.0, 500.0, 1e4, 1e12})
    for (uint64_t pixels : {uint64_t{1000}, uint64_t{1} << 18})
      for (size_t candidates : {2u, 4u, 9u}) {
        const PilotPlan plan = plan_pilot(spp, pixels, candidates, true);
        EXPECT_GE(plan.rounds, 2u);
        EXPECT_GE(plan.candidates, 2u);
        EXPECT_LE(plan.candidates, candidates);
        EXPECT_GE(2 * plan.rounds * pixels, kLeastSamples);
        const double passes = 2.0 * static_cast<double>(plan.rounds * plan.candidates);
        EXPECT_LE(passes, spp / 4);
        if (plan.rounds > 2) {
          EXPECT_LE(passes, spp / 16);
        }
        EXPECT_GT(plan.kept, 0);
        EXPECT_LE(plan.kept * spp, passes);
        EXPECT_LT(plan_pilot(spp, pixels, candidates, false).kept, plan.kept);
      }
}

TEST(errors, are_those_of_one_sample) {
  Rng rng(1, 0, 0);
  PilotErrors errors(kWidth, kHeight, 3);
  for (int round = 0; round < 16; ++round) {
    errors.add_round(0, pass(2, 0.5, rng), pass(2, 0.5, rng));
    errors.add_round(2, pass(2, 0.1, rng), pass(2, 0.1, rng));
  }
  const std::vector<double> v = errors.relmse();
  // The noise of the others' pixels makes both of them a little too small.
  EXPECT_NEAR(v[0] / expected(0.5), 0.9, 0.25);
  EXPECT_EQ(v[1], std::numeric_limits<double>::infinity());
  EXPECT_NEAR(v[2] / expected(0.1), 0.9, 0.25);
}

// A candidate that never met the light shows no variance, and is not the best for that.
TEST(errors, of_a_picture_that_stayed_black_are_large) {
  Rng rng(2, 0, 0);
  PilotErrors errors(kWidth, kHeight, 2);
  const std::vector<Vec3d> black(kPixels);
  errors.add_round(0, black, black);
  errors.add_round(1, pass(2, 0.1, rng), pass(2, 0.1, rng));
  const std::vector<double> v = errors.relmse();
  EXPECT_GT(v[0], 3 * v[1]);
  EXPECT_GT(v[1], 0.5 * expected(0.1));
}

// Half of the picture found, and all of it calm: still the other half is missed.
TEST(errors, of_a_picture_that_is_black_in_places_are_large) {
  Rng rng(3, 0, 0);
  PilotErrors errors(kWidth, kHeight, 2);
  std::vector<Vec3d> half(kPixels, Vec3d{2, 2, 2});
  std::fill(half.begin() + kPixels / 2, half.end(), Vec3d{});
  errors.add_round(0, half, half);
  errors.add_round(1, pass(2, 0.4, rng), pass(2, 0.4, rng));
  const std::vector<double> v = errors.relmse();
  EXPECT_GT(v[0], v[1]);
}

TEST(errors, twin_a_picture_that_is_as_bright_without_variance_has_none) {
  Rng rng(4, 0, 0);
  PilotErrors errors(kWidth, kHeight, 2);
  const std::vector<Vec3d> all(kPixels, Vec3d{2, 2, 2});
  errors.add_round(0, all, all);
  errors.add_round(1, pass(2, 0.4, rng), pass(2, 0.4, rng));
  const std::vector<double> v = errors.relmse();
  EXPECT_LT(v[0], 0.3 * v[1]);
}

// A rare bright sample raises the mean of its pixel and would hide itself behind it.
TEST(errors, of_fireflies_are_not_hidden_by_themselves) {
  Rng rng(5, 0, 0);
  PilotErrors errors(kWidth, kHeight, 1);
  for (int round = 0; round < 4; ++round)
    errors.add_round(0, pass(2, 0.01, rng), pass(2, 0.01, rng));
  // With the pixel's own mean of 8 samples no error above 8 could be; the truth is 98.
  EXPECT_GT(errors.relmse()[0], 30);
}

TEST(errors, without_any_light_are_zero) {
  PilotErrors errors(kWidth, kHeight, 2);
  const std::vector<Vec3d> black(kPixels);
  for (size_t i : {0u, 1u}) errors.add_round(i, black, black);
  EXPECT_EQ(errors.relmse(), (std::vector<double>{0, 0}));
}

TEST(weights, are_the_inverse_of_errors_and_add_up_to_one) {
  const std::vector<double> w = pilot_weights({1, 3, 2, 6}, {false, false, true, false});
  EXPECT_NEAR(w[0] / w[1], 3, 1e-12);
  EXPECT_NEAR(w[0] / w[3], 6, 1e-12);
  EXPECT_EQ(w[2], 0);
  EXPECT_NEAR(w[0] + w[1] + w[3], 1, 1e-12);
  EXPECT_EQ(pilot_weights({0, 0}, {true, false}), (std::vector<double>{0, 1}));
  for (double v :
       pilot_weights({0, 1, std::numeric_limits<double>::infinity()}, {false, false, false}))
    EXPECT_TRUE(std::isfinite(v));
}

TEST(decisions, weigh_error_and_work) {
  const std::vector<PilotRecord> pilot{
      {"a", 2, 4, 100, 0}, {"b", 2, 1, 300, 0}, {"c", 2, 24, 201, 0}, {"d", 2, 24, 199, 0}};
  EXPECT_EQ(best_of(pilot), 1u);
  EXPECT_EQ(hopeless(pilot, {true, false, false, false}),
            (std::vector<bool>{true, false, true, false}));
}

std::vector<std::string> names(const Scene& scene, const std::vector<Portal>& portals) {
  const World world(scene, scene.camera(""), 8, 6, portals);
  std::vector<std::string> all;
  for (const Candidate& c : auto_candidates(world, portals)) all.push_back(c.label);
  return all;
}

TEST(candidates, begin_with_what_the_portals_promise) {
  const Scene scene = read_gltf(two_rooms_path());
  using Names = std::vector<std::string>;
  EXPECT_EQ(names(scene, {}), (Names{"tdpt-guided 0.5 0.4 1", "nee", "bdpt", "pt"}));
  Portal portal = portal_in_the_hole();
  portal.figures = {{"flux_share", 1}, {"expected_gain", 3}};
  EXPECT_EQ(names(scene, {portal}), (Names{"tdpt-guided 0.5 0.4 1", "bdpt", "nee", "tdpt-org",
                                           "tdpt-guided 0.7 0.5 1", "tdpt-guided 0.5 0.2 0.25"}));
  EXPECT_FALSE(all_useless({portal}));
  portal.figures["expected_gain"] = 0.8;
  EXPECT_TRUE(all_useless({portal}));
  EXPECT_EQ(names(scene, {portal}), (Names{"bdpt", "tdpt-guided 0.5 0.4 1", "nee", "tdpt-org",
                                           "tdpt-guided 0.7 0.5 1", "tdpt-guided 0.5 0.2 0.25"}));
}

// Bright samples that two of them shared would be taken for the picture, and their error for less.
TEST(candidates, share_no_samples) {
  const Scene scene = read_gltf(two_rooms_path());
  const std::vector<Portal> portals{portal_in_the_hole()};
  const World world(scene, scene.camera(""), 8, 6, portals);
  std::set<uint64_t> streams;
  const auto candidates = auto_candidates(world, portals);
  for (const Candidate& c : candidates) streams.insert(c.integrator.stream);
  EXPECT_EQ(streams.size(), candidates.size());
}

// They would converge to another picture.
TEST(candidates, that_miss_light_of_the_scene_are_none) {
  Scene scene = read_gltf(two_rooms_path());
  scene.lights.emplace_back();
  scene.materials[0].plain = false;
  scene.materials[0].metallic = 1;
  scene.materials[0].roughness = 0;
  EXPECT_EQ(names(scene, {}), (std::vector<std::string>{"tdpt-guided 0.5 0.4 1", "bdpt"}));
  EXPECT_EQ(names(scene, {portal_in_the_hole()}),
            (std::vector<std::string>{"tdpt-guided 0.5 0.4 1", "bdpt", "tdpt-org",
                                      "tdpt-guided 0.7 0.5 1", "tdpt-guided 0.5 0.2 0.25"}));
}

}  // namespace
}  // namespace tdpt
