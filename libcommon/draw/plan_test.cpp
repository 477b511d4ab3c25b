#include "libcommon/draw/plan.h"

#include <gtest/gtest.h>

#include "libcommon/draw/sheet.h"
#include "libcommon/testing/scenes/box_house.h"

namespace tdpt::draw::plan_test {

constexpr Ink kWhite = ink(0xffffff);

// The plan of a storey of a house, of 1 m to 50 pixels.
class Drawn {
 public:
  Drawn(const TestHouse& house, size_t storey)
      : house_(house),
        tracer_(house_.scene),
        canvas_(600, 500, kWhite),
        plan_(canvas_, house_.scene, tracer_, storeys_of(house_.scene, tracer_).at(storey),
              {-1, -1, 9, 7}, {50, 20, 500, 400}) {
    plan_.paint([](uint32_t, const Vec3d&) { return kWhite; }, kWhite);
  }
  Plan& plan() { return plan_; }
  Ink at(double x, double z) const {
    return canvas_.pixels().at(static_cast<int>(50 + 50 * (x + 1)),
                               static_cast<int>(20 + 50 * (z + 1)));
  }
  bool is(const Ink& c, double x, double z) const { return length(at(x, z) - c) < 0.02f; }
  Canvas& canvas() { return canvas_; }

 private:
  TestHouse house_;
  Tracer tracer_;
  Canvas canvas_;
  Plan plan_;
};

TEST(plan, each_storey_has_its_own_walls) {
  const Drawn ground(test_house(2), 0), upper(test_house(2), 1);
  EXPECT_TRUE(ground.is(kCutWall, 4.1, 1));
  EXPECT_TRUE(ground.is(kWhite, 4.1, 2.45)) << "the doorway";
  EXPECT_TRUE(upper.is(kWhite, 4.1, 1)) << "the wall is on the ground floor";
  for (const Drawn* d : {&ground, &upper}) EXPECT_TRUE(d->is(kCutWall, 0.15, 3));
}

TEST(plan, an_opening_is_drawn_on_its_storey) {
  const Opening door{
      {{4.1, 3, 2}, {4.1, 5, 2}, {4.1, 5, 2.9}, {4.1, 3, 2.9}}, {1, 0, 0}, "a", false};
  Drawn ground(test_house(2), 0), upper(test_house(2), 1);
  for (Drawn* d : {&ground, &upper}) d->plan().openings({door});
  EXPECT_TRUE(upper.is(kPortal, 4.1, 2.2));
  EXPECT_TRUE(upper.is(kPortal, 4.25, 2.45)) << "the arrow";
  EXPECT_FALSE(ground.is(kPortal, 4.1, 2.2));
  Opening refused = door;
  refused.refused = true;
  Drawn grey(test_house(2), 1);
  grey.plan().openings({refused});
  EXPECT_TRUE(grey.is(kRefused, 4.1, 2.2));
}

TEST(plan, a_line_is_drawn_as_far_as_it_is_within_the_storey) {
  Drawn ground(test_house(2), 0);
  // Goes up to the slab at half its way.
  ground.plan().line({1, 0.1, 3}, {3, 5.5, 3}, 3, {1, 0, 0}, 1);
  EXPECT_FALSE(ground.is(kWhite, 1.5, 3));
  EXPECT_TRUE(ground.is(kWhite, 2.5, 3));
}

TEST(plan, the_camera_sees_no_further_than_the_wall) {
  TestHouse h = test_house(1, false);
  Camera camera;
  camera.position = {3, 1.5, 3};
  camera.forward = {1, 0, 0}, camera.up = {0, 1, 0}, camera.right = {0, 0, 1};
  camera.yfov = 0.6;
  Drawn d(h, 0);
  d.plan().camera(camera);
  EXPECT_FALSE(d.is(kWhite, 3.7, 3));
  EXPECT_TRUE(d.is(kWhite, 4.4, 3)) << "behind the wall";
}

TEST(extent, holds_a_camera_before_the_house_and_not_one_far_away) {
  const TestHouse h = test_house(1);
  const Tracer tracer(h.scene);
  const auto storeys = storeys_of(h.scene, tracer);
  const Extent house = extent_of(storeys, {}), near = extent_of(storeys, {{10, 1, 3}}),
               far = extent_of(storeys, {{100, 1, 3}});
  EXPECT_GT(near.high_x, 10);
  EXPECT_EQ(near.low_x, house.low_x);
  EXPECT_EQ(far.high_x, house.high_x);
}

}  // namespace tdpt::draw::plan_test
