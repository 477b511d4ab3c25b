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

// The mean of independent estimates, and its standard error.
struct Estimate {
  double mean, error;
  bool agrees(double truth) const { return std::abs(mean - truth) < 4 * error; }
};
Estimate estimate(const Square& from, const Square& to) {
  double sum = 0, squares = 0;
  const int runs = 50;
  for (int k = 0; k < runs; ++k) {
    const double f = between(from, to, static_cast<uint64_t>(k), 200);
    sum += f;
    squares += f * f;
  }
  const double mean = sum / runs;
  const double error = std::sqrt(std::max(0.0, squares / runs - mean * mean) / (runs - 1));
  EXPECT_LT(error, 0.01 * mean) << "too noisy to tell";
  return {mean, error};
}

const Square kFloor = square({0, 0, 0}, {0, 0, 1}, {1, 0, 0});    // faces up
const Square kCeiling = square({0, 1, 0}, {1, 0, 0}, {0, 0, 1});  // faces down
const Square kWall = square({0, 0, 0}, {0, 1, 0}, {0, 0, 1});     // x = 0, faces +x
const double kPi = std::numbers::pi;
// X = Y = 1 in C-11: (2/pi) [ln sqrt(4/3) + 2 sqrt 2 atan(1/sqrt 2) - 2 atan 1].
const double kParallel =
    2 / kPi *
    (0.5 * std::log(4.0 / 3) + 2 * std::sqrt(2.0) * std::atan(std::sqrt(0.5)) - 2 * std::atan(1.0));

TEST(form_factor, of_unit_squares_is_that_of_the_closed_forms) {
  EXPECT_NEAR(kParallel, 0.19982, 1e-5);
  const Estimate facing = estimate(kFloor, kCeiling);
  EXPECT_TRUE(facing.agrees(kParallel));
  const Estimate corner = estimate(kFloor, kWall);  // with a common edge
  EXPECT_TRUE(corner.agrees(0.2000437761));
  // Twins: a dropped pi or cosine, and 5 per cent too much.
  EXPECT_FALSE(facing.agrees(kParallel * kPi));
  EXPECT_FALSE(facing.agrees(kParallel * 1.05));
  EXPECT_FALSE(corner.agrees(0.2000437761 * 1.05));
}

// A_i F_ij = A_j F_ji for areas 1 and 4; twin: areas left out.
TEST(form_factor, is_reciprocal) {
  const Square large = square({-1, 1, -1}, {2, 0, 0}, {0, 0, 2});
  const double forth = between(kFloor, large, 1, 600), back = between(large, kFloor, 2, 600);
  EXPECT_NEAR(forth / (4 * back), 1, 0.02);
  EXPECT_GT(forth / back, 1.1);
}

// Twin: those of an open box do not.
TEST(form_factor, rows_of_a_closed_box_add_up_to_1) {
  double sum = 0;
  for (const Square& wall :
       {kWall, square({1, 0, 0}, {0, 0, 1}, {0, 1, 0}), square({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
        square({0, 0, 1}, {0, 1, 0}, {1, 0, 0})})
    sum += between(kFloor, wall, 10, 700);
  EXPECT_LT(sum, 0.9);
  EXPECT_NEAR(sum + between(kFloor, kCeiling, 14, 700), 1, 0.02);
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
