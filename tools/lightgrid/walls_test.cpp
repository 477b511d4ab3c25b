#include "tools/lightgrid/building.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tools/lightgrid/lightgrid.h"

namespace tdpt::walls_test {

void add_triangle(Scene& scene, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const auto first = static_cast<uint32_t>(scene.positions.size());
  for (const Vec3d& p : {a, b, c}) scene.positions.emplace_back(p);
  scene.triangles.push_back({{first, first + 1, first + 2}, 0});
}

void add_quad(Scene& scene, const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
  add_triangle(scene, corner, corner + u, corner + u + v);
  add_triangle(scene, corner, corner + u + v, corner + v);
}

constexpr double kTurn = 0.3;  // [rad]

// Four walls and a floor, turned about y; the walls face inwards.
Scene turned_room() {
  Scene scene;
  const Vec3d x{std::cos(kTurn), 0, std::sin(kTurn)}, z{-std::sin(kTurn), 0, std::cos(kTurn)};
  const Vec3d up{0, 0.4, 0};
  add_quad(scene, {}, z, x);
  add_quad(scene, {}, x, up);
  add_quad(scene, z, up, x);
  add_quad(scene, {}, up, z);
  add_quad(scene, x, z, up);
  return scene;
}

void add_ball(Scene& scene, double radius) {
  constexpr int kAround = 48, kDown = 24;
  const auto at = [&](int i, int j) {
    const double phi = 2 * std::numbers::pi * i / kAround, theta = std::numbers::pi * j / kDown;
    return Vec3d{std::sin(theta) * std::cos(phi), std::cos(theta),
                 std::sin(theta) * std::sin(phi)} *
           radius;
  };
  for (int i = 0; i < kAround; ++i)
    for (int j = 0; j < kDown; ++j) {
      add_triangle(scene, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add_triangle(scene, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
}

bool has(const std::vector<Vec3d>& directions, const Vec3d& n) {
  return std::any_of(directions.begin(), directions.end(),
                     [&](const Vec3d& d) { return std::abs(dot(d, n)) > 1 - 1e-6; });
}

TEST(Walls, face_as_most_surfaces_do) {
  Scene scene = turned_room();
  const std::vector<Vec3d> walls = wall_directions(scene, empty_grid(scene, 8));
  ASSERT_EQ(walls.size(), 3u);
  EXPECT_TRUE(has({walls[0]}, {0, 1, 0}));  // the floor is the largest
  EXPECT_TRUE(has(walls, {std::cos(kTurn), 0, std::sin(kTurn)}));
  EXPECT_TRUE(has(walls, {-std::sin(kTurn), 0, std::cos(kTurn)}));
  // A ball of more surface than the room adds none.
  add_ball(scene, 0.7);
  EXPECT_EQ(wall_directions(scene, empty_grid(scene, 8)).size(), 3u);
}

// The ends of a long house are little surface, but stand at right angles to what is much.
TEST(Walls, stand_at_right_angles) {
  Scene scene;
  add_quad(scene, {}, {0, 0, 1}, {60, 0, 0});
  add_quad(scene, {}, {60, 0, 0}, {0, 1, 0});
  const std::vector<Vec3d> walls = wall_directions(scene, empty_grid(scene, 8));
  EXPECT_EQ(walls.size(), 3u);
  EXPECT_TRUE(has(walls, {1, 0, 0}));
  // Twin: a roof that is not at right angles to the ground gives no third.
  Scene roof;
  add_quad(roof, {}, {0, 0, 1}, {60, 0, 0});
  add_quad(roof, {}, {60, 0, 0}, {0, 1, 1});
  EXPECT_EQ(wall_directions(roof, empty_grid(roof, 8)).size(), 2u);
}

// What lies outside the grid is not of this building.
TEST(Walls, are_those_within_the_grid) {
  Scene scene = turned_room();
  const LightGrid here = empty_grid(scene, 8);
  add_quad(scene, {50, 0, 50}, {9, 0, 0}, {0, 9, 9});
  EXPECT_EQ(wall_directions(scene, here).size(), 3u);
  EXPECT_EQ(wall_directions(scene, empty_grid(scene, 8)).size(), 1u);  // twin
}

}  // namespace tdpt::walls_test
