#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tools/lightgrid/lightgrid.h"

namespace tdpt::building_test {

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

// A box with faces that point outwards, of one material.
void add_box(Scene& scene, const Vec3d& low, const Vec3d& high, uint32_t material) {
  const auto first = static_cast<uint32_t>(scene.positions.size());
  for (uint32_t c = 0; c < 8; ++c)
    scene.positions.emplace_back(
        Vec3d{c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z});
  for (const auto& q : std::initializer_list<std::array<uint32_t, 4>>{
           {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}) {
    scene.triangles.push_back({{first + q[0], first + q[1], first + q[2]}, material});
    scene.triangles.push_back({{first + q[0], first + q[2], first + q[3]}, material});
  }
}

Scene scene_of_glass() {
  Scene scene;
  scene.materials.resize(2);
  scene.materials[0].transmission = 1;
  scene.materials[0].solid = true;
  return scene;
}

TEST(Panes, are_sheets_of_solid_glass) {
  Scene scene = scene_of_glass();
  scene.frame = {{5, 0, 0}, 0.5};  // a metre is half a unit
  add_box(scene, {0, 0, 0}, {1, 1, 0.01}, 0);
  const std::vector<GridPane> panes = solid_panes(scene);
  ASSERT_EQ(panes.size(), 1u);
  EXPECT_NEAR(length(panes[0].back - panes[0].front), 0.02, 1e-6);
  EXPECT_NEAR(std::abs(panes[0].back.z - panes[0].front.z), 0.02, 1e-6);
  EXPECT_NEAR(panes[0].front.x, 6, 0.5);
  // Beside it in its plane is no other; behind it is.
  add_box(scene, {2, 0, 0}, {3, 1, 0.01}, 0);
  EXPECT_EQ(solid_panes(scene).size(), 1u);
  add_box(scene, {0, 0, 0.02}, {1, 1, 0.03}, 0);
  const std::vector<GridPane> two = solid_panes(scene);
  ASSERT_EQ(two.size(), 2u);
  for (const GridPane& pane : two) EXPECT_NEAR(length(pane.back - pane.front), 0.02, 1e-6);
}

TEST(Panes, are_no_other_things) {
  const auto panes = [](bool solid, uint32_t material, bool inwards, double thickness) {
    Scene scene = scene_of_glass();
    scene.materials[0].solid = solid;
    add_box(scene, {0, 0, 0}, {1, 1, thickness}, material);
    if (inwards)
      for (Triangle& t : scene.triangles) std::swap(t.vertex[1], t.vertex[2]);
    return solid_panes(scene).size();
  };
  EXPECT_EQ(panes(true, 0, false, 0.01), 1u);
  EXPECT_EQ(panes(false, 0, false, 0.01), 0u);  // a sheet of thin glass
  EXPECT_EQ(panes(true, 1, false, 0.01), 0u);   // a board
  EXPECT_EQ(panes(true, 0, true, 0.01), 0u);    // air within glass
  EXPECT_EQ(panes(true, 0, false, 1.01), 0u);   // a block
}

}  // namespace tdpt::building_test
