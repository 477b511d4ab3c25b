#include "libcommon/flow/potential_sweep.h"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

namespace tdpt::potential_sweep_test {

// Four patches in a row, the light at the first and the camera at the last; the arcs between the
// two in the middle have a tenth of the others' capacity.
PatchNetwork row() {
  PatchNetwork p;
  p.scale = 1000;
  p.network = {6, 0, 1, {{0, 2, 1000}, {5, 1, 1000}}};
  p.samples = {0, 0, 1, 1, 1, 1};
  const int64_t capacity[] = {400, 40, 400};
  for (uint32_t v = 2; v < 5; ++v)
    for (const auto& [a, b] : {std::pair{v, v + 1}, std::pair{v + 1, v}})
      p.network.arcs.push_back({a, b, capacity[v - 2]});
  return p;
}

TEST(potential_sweep, is_that_of_resistors_in_a_row) {
  const Sweep s = sweep_of(row());
  ASSERT_EQ(s.order, (std::vector<uint32_t>{2, 3, 4, 5}));
  // Held at either end, through 1/300, where one terminal has four times its mean and the other
  // nothing; 1/400, 1/40, 1/400 between.
  const double end = std::log(4 / 1e-5), whole = 2 / 300.0 + 0.03;
  const double from_first[] = {1 / 300.0, 1 / 300.0 + 0.0025, 1 / 300.0 + 0.0275, 1 / 300.0 + 0.03};
  for (uint32_t i = 0; i < 4; ++i)
    EXPECT_NEAR(s.u[2 + i], end * (2 * from_first[i] / whole - 1), 1e-5) << i;
}

// Walks that hit the patches stand for light that is not known.
TEST(potential_sweep, takes_walks_for_light) {
  PatchNetwork lit = row(), known = row();
  lit.lit = {0, 0, 80, 40, 20, 10}, lit.viewed = {0, 0, 10, 20, 40, 80};
  known.brightness = {0, 0, 8, 4, 2, 1}, known.importance = {0, 0, 1, 2, 4, 8};
  const Sweep walks = sweep_of(lit), light = sweep_of(known);
  for (uint32_t v = 2; v < 6; ++v) EXPECT_NEAR(walks.u[v], light.u[v], 1e-9);
  EXPECT_GT(std::abs(sweep_of(row()).u[2] - light.u[2]), 1);  // twin: terminals alone
}

TEST(potential_sweep, has_its_narrowest_cut_where_the_potential_drops) {
  const Sweep s = sweep_of(row());
  EXPECT_EQ(s.crossing, (std::vector<double>{400, 40, 400, 0}));
  EXPECT_EQ(s.between(1, 4).area, 3);
  EXPECT_DOUBLE_EQ(s.conductance(2, 0, 4), 40.0 / (400 + 440));
  EXPECT_DOUBLE_EQ(s.conductance(1, 0, 4), 1);  // all of the smaller side crosses it
}

// Where the light is known the potential is the ratio of importance to brightness: a lamp in a room
// aside, whose light never reaches the camera, makes no room on the way a part of the light's.
TEST(potential_sweep, follows_the_light_that_reaches_the_camera) {
  PatchNetwork p = row();
  p.brightness = {0, 0, 8, 4, 2, 1};
  p.importance = {0, 0, 1, 2, 4, 8};
  const Sweep s = sweep_of(p);
  EXPECT_EQ(s.order, (std::vector<uint32_t>{2, 3, 4, 5}));
  EXPECT_NEAR(s.u[2], std::log(1.0 / 8), 0.8);
  EXPECT_NEAR(s.u[5], std::log(8.0), 0.8);
  EXPECT_GT(s.u[4] - s.u[3], CutLimits{}.least_drop);  // across the narrow arc, by a factor of four
  // Twin: the camera where the light was.
  std::swap(p.brightness, p.importance);
  EXPECT_EQ(sweep_of(p).order, (std::vector<uint32_t>{5, 4, 3, 2}));
}

TEST(terminal_grades, are_relative_to_half_the_hit_weighted_median) {
  // E = 10, 2, 1; hits 100, 20, 10: the median by hits is 10, half of it 5.
  const auto g = terminal_grades({100, 20, 10, 0, 7}, {10, 10, 10, 10, 0});
  EXPECT_EQ(g, (std::vector<double>{1, 0.4, 0.2, 0, 0}));
  EXPECT_EQ(terminal_grades({0, 0}, {1, 1}), (std::vector<double>{0, 0}));
}

}  // namespace tdpt::potential_sweep_test
