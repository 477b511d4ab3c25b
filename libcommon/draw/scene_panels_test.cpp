#include "libcommon/draw/scene_panels.h"

#include <gtest/gtest.h>

#include "libcommon/testing/scenes/box_house.h"

namespace tdpt::draw::scene_panels_test {

// Rooms x 0..2 and 2.1..4.1, hole y 0.875..1.125, z -0.125..0.125; the camera in the first.
const Scene& two_rooms() {
  static const Scene scene = read_gltf(TDPT_TESTDATA "/scenes/two-rooms.glb");
  return scene;
}

Ink at(const Panel& panel, const Vec3d& metres) {
  const Pixel p = panel.view.project(metres);
  return panel.backdrop.at(static_cast<int>(p.x - panel.view.panel.x),
                           static_cast<int>(p.y - panel.view.panel.y));
}
bool is(const Ink& c, const Panel& panel, const Vec3d& metres) {
  return length(at(panel, metres) - c) < 0.02f;
}

TEST(scene_panels, plan_and_camera_show_the_surfaces_where_they_are) {
  // Each room in its own colour.
  const auto panels = scene_panels(
      two_rooms(), two_rooms().camera(""), {},
      [](uint32_t, const Vec3d& place) {
        return two_rooms().frame.to_metres(place).x < 2.05 ? Ink{0, 0, 1} : Ink{1, 0, 0};
      },
      true);
  ASSERT_EQ(panels.size(), 2u);
  // Floors face the plan's light, so they have exactly the given colour.
  EXPECT_TRUE(is({0, 0, 1}, panels[1], {0.4, 0, -0.8}));
  EXPECT_TRUE(is({1, 0, 0}, panels[1], {3.9, 0, 0.8}));
  EXPECT_TRUE(is(kCutWall, panels[1], {2.05, 0, 0.2}));
  // The camera sees its own back wall, and the other room through the hole only.
  const Ink wall = at(panels[0], {2, 1.5, -0.5});
  EXPECT_GT(wall.z, 0.6f);
  EXPECT_EQ(wall.x, 0);
  const Ink hole = at(panels[0], {2.1, 1.05, -0.05});
  EXPECT_GT(hole.x, 0.6f);
  EXPECT_EQ(hole.z, 0);
}

std::vector<Panel> plans_of(const TestHouse& house, const Vec3d& eye,
                            const std::vector<Vec3d>& places = {}) {
  Camera camera;
  camera.position = eye;
  camera.forward = {1, 0, 0}, camera.up = {0, 1, 0}, camera.right = {0, 0, 1};
  camera.yfov = 0.6;
  return scene_panels(
      house.scene, camera, places,
      [](uint32_t, const Vec3d&) {
        return Ink{1, 1, 1};
      },
      false);
}

TEST(scene_panels, each_storey_has_its_own_walls) {
  const auto plans = plans_of(test_house(2), {3, 1.5, 3}, {{3, 4, 3}});
  ASSERT_EQ(plans.size(), 2u);
  EXPECT_TRUE(is(kCutWall, plans[0], {4.1, 0, 1}));
  EXPECT_TRUE(is({1, 1, 1}, plans[0], {4.1, 0, 2.45})) << "the doorway";
  EXPECT_TRUE(is({1, 1, 1}, plans[1], {4.1, 0, 1})) << "the wall is on the ground floor";
  for (const Panel& plan : plans) {
    EXPECT_TRUE(is(kCutWall, plan, {0.15, 0, 3}));
    EXPECT_NE(plan.shows({3, 1.5, 3}), plan.shows({3, 4, 3}));
  }
}

TEST(scene_panels, the_camera_sees_no_further_than_the_wall_and_is_shown_unless_far_away) {
  const TestHouse house = test_house(1, false);
  const Panel plan = plans_of(house, {3, 1.5, 3})[0];
  const auto cone = std::find_if(plan.shapes.begin(), plan.shapes.end(),
                                 [](const Shape& s) { return s.name == "camera"; });
  ASSERT_NE(cone, plan.shapes.end());
  double far = 0;
  for (const Vec3d& p : cone->positions) far = std::max(far, p.x);
  EXPECT_NEAR(far, 4, 1e-3);
  EXPECT_EQ(plan.labels.at(0).words, "camera");
  const auto width = [&](const Vec3d& eye) { return plans_of(house, eye)[0].view.half_width; };
  EXPECT_GT(width({10, 1, 3}), plan.view.half_width);
  EXPECT_EQ(width({100, 1, 3}), plan.view.half_width);
}

TEST(patch_lookup, finds_the_finest_patch_of_the_face_and_cell) {
  const Frame frame{{1, 0, 0}, 0.5};
  Patch coarse{}, fine{};
  coarse.cell = {0, 0, 0};
  coarse.faces = {4};
  fine.level = 1;
  fine.cell = {3, 0, 0};
  fine.faces = {4};
  const PatchLookup lookup(frame, {{0, 0, 0}, 1}, {coarse, fine});
  const auto at = [&](uint32_t face, double x) {
    return lookup.at(face, frame.to_canonical({x, 0.1, 0.1}));
  };
  EXPECT_EQ(at(4, 0.3), 0u);
  EXPECT_EQ(at(4, 0.8), 1u);
  EXPECT_FALSE(at(5, 0.3));
  EXPECT_FALSE(at(4, 1.3));
}

}  // namespace tdpt::draw::scene_panels_test
