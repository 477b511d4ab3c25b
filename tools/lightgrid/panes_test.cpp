#include "tools/lightgrid/building.h"

#include <gtest/gtest.h>

namespace tdpt::panes_test {

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
  const std::vector<Pane> panes = solid_panes(scene);
  ASSERT_EQ(panes.size(), 1u);
  EXPECT_NEAR(length(panes[0].back - panes[0].front), 0.02, 1e-6);
  EXPECT_NEAR(std::abs(panes[0].back.z - panes[0].front.z), 0.02, 1e-6);
  EXPECT_NEAR(panes[0].front.x, 6, 0.5);
  // Beside it in its plane is no other; behind it is.
  add_box(scene, {2, 0, 0}, {3, 1, 0.01}, 0);
  EXPECT_EQ(solid_panes(scene).size(), 1u);
  add_box(scene, {0, 0, 0.02}, {1, 1, 0.03}, 0);
  const std::vector<Pane> two = solid_panes(scene);
  ASSERT_EQ(two.size(), 2u);
  for (const Pane& pane : two) EXPECT_NEAR(length(pane.back - pane.front), 0.02, 1e-6);
}

TEST(Panes, are_no_other_things) {
  Scene thin = scene_of_glass();
  thin.materials[0].solid = false;
  add_box(thin, {0, 0, 0}, {1, 1, 0.01}, 0);
  EXPECT_TRUE(solid_panes(thin).empty());
  Scene board = scene_of_glass();
  add_box(board, {0, 0, 0}, {1, 1, 0.01}, 1);
  EXPECT_TRUE(solid_panes(board).empty());
  Scene cavity = scene_of_glass();  // air within glass: faces that point at each other
  add_box(cavity, {0, 0, 0}, {1, 1, 0.01}, 0);
  for (Triangle& t : cavity.triangles) std::swap(t.vertex[1], t.vertex[2]);
  EXPECT_TRUE(solid_panes(cavity).empty());
  Scene block = scene_of_glass();
  add_box(block, {0, 0, 0}, {1, 1, 1.01}, 0);
  add_box(block, {2, 0.1, 0.1}, {2.5, 0.6, 0.61}, 0);
  EXPECT_TRUE(solid_panes(block).empty());
}

}  // namespace tdpt::panes_test
