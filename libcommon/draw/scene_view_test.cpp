#include "libcommon/draw/scene_view.h"

#include <gtest/gtest.h>

#include "libcommon/draw/scene_sheet.h"

namespace tdpt::draw::scene_view_test {

// Rooms x 0..2 and 2.1..4.1, hole y 0.875..1.125, z -0.125..0.125; the camera in the first.
const Scene& two_rooms() {
  static const Scene scene = read_gltf(TDPT_TESTDATA "/scenes/two-rooms.glb");
  return scene;
}

TEST(projection, ray_and_project_are_inverse) {
  const Camera& camera = two_rooms().camera("");
  const Box panel{30, 50, 400, 300};
  for (const Projection& p : {Projection::of_camera(camera, panel),
                              Projection::flat({0.1, 0.2, 0}, {1, 0, 0}, {0, 0, -1}, 1.2, panel)})
    for (const Point at : {Point{31, 51}, Point{230, 200}, Point{400, 340.5}}) {
      Vec3d from, w;
      p.ray(at, from, w);
      const Point back = p.project(from + w * 0.7);
      EXPECT_NEAR(back.x, at.x, 1e-9);
      EXPECT_NEAR(back.y, at.y, 1e-9);
      EXPECT_NEAR(p.depth(from + w * 0.7), 0.7 * dot(w, p.forward), 1e-12);
    }
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

class Sheet : public ::testing::Test {
 protected:
  Sheet() : sheet_(two_rooms(), two_rooms().camera(""), "title", "sentence", {}, 20) {}
  static Vec3d canonical(const Vec3d& metres) { return two_rooms().frame.to_canonical(metres); }
  Ink at(const auto& view, const Vec3d& metres) {
    const Point p = view.projection().project(canonical(metres));
    return sheet_.canvas().pixels().at(static_cast<int>(p.x), static_cast<int>(p.y));
  }
  SceneSheet sheet_;
};

TEST_F(Sheet, plan_and_camera_show_the_surfaces_where_they_are) {
  // Each room in its own colour.
  sheet_.paint([](uint32_t, const Vec3d& place) {
    return two_rooms().frame.to_metres(place).x < 2.05 ? Ink{0, 0, 1} : Ink{1, 0, 0};
  });
  // Floors face the plan's light, so they have exactly the given colour.
  EXPECT_EQ(at(sheet_.plans().front(), {0.4, 0, -0.8}), (Ink{0, 0, 1}));
  EXPECT_EQ(at(sheet_.plans().front(), {3.9, 0, 0.8}), (Ink{1, 0, 0}));
  EXPECT_LT(length(at(sheet_.plans().front(), {2.05, 0, 0.2}) - kCutWall), 0.01f);
  // The camera sees its own back wall, and the other room through the hole only.
  const Ink wall = at(sheet_.camera_view(), {2, 1.5, -0.5});
  EXPECT_GT(wall.z, 0.6f);
  EXPECT_EQ(wall.x, 0);
  const Ink hole = at(sheet_.camera_view(), {2.1, 1.05, -0.05});
  EXPECT_GT(hole.x, 0.6f);
  EXPECT_EQ(hole.z, 0);
}

TEST_F(Sheet, lines_are_paler_behind_a_wall) {
  sheet_.paint([](uint32_t, const Vec3d&) { return Ink{1, 1, 1}; });
  EXPECT_TRUE(sheet_.camera_view().in_sight(canonical({1.9, 1.5, -0.5})));
  EXPECT_FALSE(sheet_.camera_view().in_sight(canonical({3, 1.5, -0.9})));
  sheet_.line({1.9, 1.4, -0.8}, {1.9, 1.4, -0.2}, 3, {0, 0, 0}, 1);
  sheet_.line({3, 1.6, -1.0}, {3, 1.6, 0.2}, 3, {0, 0, 0}, 1);
  const float before = at(sheet_.camera_view(), {1.9, 1.4, -0.5}).x,
              behind = at(sheet_.camera_view(), {3, 1.6, -0.5}).x;
  EXPECT_LT(before, 0.1f);
  EXPECT_GT(behind, 0.4f);
  EXPECT_LT(behind, 0.9f);
}

TEST_F(Sheet, what_lies_behind_the_camera_is_not_drawn) {
  sheet_.paint([](uint32_t, const Vec3d&) { return Ink{1, 1, 1}; });
  const std::string before = sheet_.canvas().png();
  const Camera& c = two_rooms().camera("");
  const Vec3d behind = two_rooms().frame.to_metres(c.position - c.forward * 0.05);
  SceneView view = sheet_.camera_view();
  view.line(canonical(behind), canonical(behind + Vec3d{0, 0.01, 0}), 3, {0, 0, 0});
  view.dot_at(canonical(behind), 3, {0, 0, 0});
  EXPECT_EQ(sheet_.canvas().png(), before);
}

}  // namespace tdpt::draw::scene_view_test
