#include <numbers>

#include <gtest/gtest.h>

#include "tools/ffgraph/triangle_flow.h"

namespace tdpt::triangle_flow_test {

// Closed forms: J. R. Howell's catalogue of configuration factors, C-11 (parallel squares) and C-14
// (perpendicular rectangles with a common edge). Squares are two triangles, so
// F_AB = (1/A) sum over triangles i of A, j of B: A_i F_ij.

using Square = std::array<TriangleShape, 2>;

Square square(const Vec3d& corner, const Vec3d& a, const Vec3d& b) {
  const Vec3d n = normalize(cross(a, b));
  const double area = 0.5 * length(cross(a, b));
  return {{{corner, a, b, n, area}, {corner + a + b, -a, -b, n, area}}};
}

double between(const Square& from, const Square& to, uint64_t seed, int points = 300) {
  double sum = 0;
  for (uint32_t i = 0; i < 2; ++i)
    for (uint32_t j = 0; j < 2; ++j) {
      Rng rng(seed, i, j);
      sum += from[i].area * form_factor(from[i], to[j], points, points, rng, nullptr);
    }
  return sum / (from[0].area + from[1].area);
}

// Whether the mean of independent estimates is within 4 standard errors and 1 % of `truth`.
bool agrees(const Square& from, const Square& to, double truth) {
  double sum = 0, squares = 0;
  const int runs = 100;
  for (int k = 0; k < runs; ++k) {
    const double f = between(from, to, static_cast<uint64_t>(k), 200);
    sum += f;
    squares += f * f;
  }
  const double mean = sum / runs;
  const double error = std::sqrt(std::max(0.0, squares / runs - mean * mean) / (runs - 1));
  EXPECT_LT(error, 0.01 * mean) << "too noisy to tell";
  return std::abs(mean - truth) < 4 * error;
}

const Square kFloor = square({0, 0, 0}, {0, 0, 1}, {1, 0, 0});    // faces up
const Square kCeiling = square({0, 1, 0}, {1, 0, 0}, {0, 0, 1});  // faces down
const Square kWall = square({0, 0, 0}, {0, 1, 0}, {0, 0, 1});     // x = 0, faces +x
const double kPi = std::numbers::pi;
// X = Y = 1 in C-11: (2/pi) [ln sqrt(4/3) + 2 sqrt 2 atan(1/sqrt 2) - 2 atan 1].
const double kParallel =
    2 / kPi *
    (0.5 * std::log(4.0 / 3) + 2 * std::sqrt(2.0) * std::atan(std::sqrt(0.5)) - 2 * std::atan(1.0));

TEST(form_factor, parallel_unit_squares_at_distance_1) {
  EXPECT_NEAR(kParallel, 0.19982, 1e-5);
  EXPECT_TRUE(agrees(kFloor, kCeiling, kParallel));
}
TEST(form_factor, twin_a_dropped_pi_or_cosine_is_caught) {
  EXPECT_FALSE(agrees(kFloor, kCeiling, kParallel * kPi));
  EXPECT_FALSE(agrees(kFloor, kCeiling, kParallel * 1.05));
}

TEST(form_factor, perpendicular_unit_squares_with_a_common_edge) {
  EXPECT_TRUE(agrees(kFloor, kWall, 0.2000437761));
}
TEST(form_factor, twin_5_percent_too_much_is_caught_on_the_wall) {
  EXPECT_FALSE(agrees(kFloor, kWall, 0.2000437761 * 1.05));
}

// A_i F_ij = A_j F_ji for areas 1 and 4.
bool reciprocal(double fault) {
  const Square large = square({-1, 1, -1}, {2, 0, 0}, {0, 0, 2});
  const double forth = between(kFloor, large, 1, 600) * 1;
  const double back = between(large, kFloor, 2, 600) * 4 * fault;
  return std::abs(forth / back - 1) < 0.02;
}
TEST(form_factor, is_reciprocal) {
  EXPECT_TRUE(reciprocal(1));
}
TEST(form_factor, twin_areas_left_out_break_reciprocity) {
  EXPECT_FALSE(reciprocal(0.25));
}

double row_of_a_box(bool with_lid) {
  std::vector<Square> others{kWall, square({1, 0, 0}, {0, 0, 1}, {0, 1, 0}),
                             square({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                             square({0, 0, 1}, {0, 1, 0}, {1, 0, 0})};
  if (with_lid) others.push_back(kCeiling);
  double sum = 0;
  for (size_t k = 0; k < others.size(); ++k) sum += between(kFloor, others[k], 10 + k, 700);
  return sum;
}
TEST(form_factor, rows_of_a_closed_box_add_up_to_1) {
  EXPECT_NEAR(row_of_a_box(true), 1, 0.02);
}
TEST(form_factor, twin_an_open_box_does_not) {
  EXPECT_LT(row_of_a_box(false), 0.9);
}

TEST(form_factor, is_0_for_sides_that_face_away) {
  EXPECT_EQ(between(kCeiling, square({0, 2, 0}, {1, 0, 0}, {0, 0, 1}), 1), 0);
}

// A screen that blocks the whole view.
TEST(form_factor, is_0_through_a_wall_and_whole_without) {
  Scene scene;
  scene.positions = {
      {-0.9f, 0.5f, -0.9f}, {0.9f, 0.5f, -0.9f}, {0.9f, 0.5f, 0.9f}, {-0.9f, 0.5f, 0.9f}};
  scene.materials.resize(1);
  scene.triangles = {{{0, 1, 2}, 0}, {{0, 2, 3}, 0}};
  const Tracer tracer(scene);
  const TriangleShape low{{0, 0, 0}, {0, 0, 0.1}, {0.1, 0, 0}, {0, 1, 0}, 0.005};
  const TriangleShape high{{0, 1, 0}, {0.1, 0, 0}, {0, 0, 0.1}, {0, -1, 0}, 0.005};
  Rng rng(1, 0, 0);
  EXPECT_EQ(form_factor(low, high, 8, 8, rng, &tracer), 0);
  const TriangleShape near{{0, 0.4, 0}, {0.1, 0, 0}, {0, 0, 0.1}, {0, -1, 0}, 0.005};
  EXPECT_GT(form_factor(low, near, 8, 8, rng, &tracer), 0);
}

}  // namespace tdpt::triangle_flow_test
