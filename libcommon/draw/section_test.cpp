#include "libcommon/draw/section.h"

#include <gtest/gtest.h>

#include "libcommon/testing/scenes/box_house.h"

namespace tdpt::draw::section_test {

const Scene& two_rooms() {
  static const Scene scene = read_gltf(TDPT_TESTDATA "/scenes/two-rooms.glb");
  return scene;
}

TEST(section, is_as_long_as_the_walls_that_it_cuts) {
  const Scene& scene = two_rooms();
  const auto metres_at = [&](double y) {
    double sum = 0;
    for (const Segment& s : section(scene, y)) sum += length(s.b - s.a);
    return sum;
  };
  EXPECT_NEAR(metres_at(1.5), 16, 1e-5);
  // Through the hole: two walls lack its width, its two jambs are added.
  EXPECT_NEAR(metres_at(1.0), 16 - 2 * 0.25 + 2 * 0.1, 1e-5);
}

// Walls of a house, seen from 1 m around it in cells of 2 cm.
class Plan {
 public:
  explicit Plan(const TestHouse& house, std::vector<Vec3d> air = {{2, 1.5, 3}, {6, 1.5, 3}})
      : walls_(walls(house.scene, section(house.scene, 1.5), kGrid, air, 1.2)) {}
  bool is_wall(double x, double z) const { return walls_[*kGrid.cell_at({x, 0, z})]; }

 private:
  static constexpr CellGrid kGrid{-1, -1, 0.02, 500, 400};
  std::vector<bool> walls_;
};

TEST(walls, walls_are_and_rooms_and_doorways_are_not) {
  const Plan plan(test_house(1));
  for (const auto& [x, z] : {std::pair(0.15, 3.0), std::pair(7.85, 1.0), std::pair(5.0, 0.15),
                             std::pair(4.1, 1.0), std::pair(4.1, 5.0)})
    EXPECT_TRUE(plan.is_wall(x, z)) << x << ' ' << z;
  EXPECT_TRUE(plan.is_wall(0.15, 0.15)) << "where two walls overlap";
  for (const auto& [x, z] : {std::pair(2.0, 3.0), std::pair(6.0, 1.0), std::pair(-0.5, 3.0),
                             std::pair(4.1, 2.1), std::pair(4.1, 2.8)})
    EXPECT_FALSE(plan.is_wall(x, z)) << x << ' ' << z;
  EXPECT_TRUE(Plan(test_house(1, false)).is_wall(4.1, 2.45)) << "twin: without a doorway";
}

TEST(walls, an_open_sheet_spoils_nothing) {
  TestHouse h = test_house(1);
  h.quad({2, 0, 2}, {2, 2.5, 2}, {2, 2.5, 4}, {2, 0, 4});
  const Plan plan(h, {{1, 1.5, 3}, {3, 1.5, 3}, {6, 1.5, 3}, {6, 1.5, 1}});
  EXPECT_FALSE(plan.is_wall(1, 3));
  EXPECT_FALSE(plan.is_wall(3, 3));
  EXPECT_TRUE(plan.is_wall(0.15, 3));
  EXPECT_TRUE(plan.is_wall(4.1, 3.5));
}

TEST(walls, between_rooms_without_outer_sides_is_a_wall) {
  TestHouse h;
  h.box({0, 0, 0}, {3.9, 2.5, 6}, false);
  h.box({4.1, 0, 0}, {8, 2.5, 6}, false);
  const Plan plan(h);
  EXPECT_TRUE(plan.is_wall(4, 3));
  EXPECT_FALSE(plan.is_wall(2, 3));
}

TEST(walls, a_body_thicker_than_a_wall_is_none) {
  TestHouse h = test_house(1);
  h.box({-0.9, -1, -5}, {0, 2.5, 12});  // 0.9 m are a wall still
  EXPECT_TRUE(Plan(h).is_wall(-0.5, 3));
  h.box({8, -1, -5}, {12, 2.5, 12});
  EXPECT_FALSE(Plan(h).is_wall(8.5, 3));
  EXPECT_TRUE(Plan(h).is_wall(7.85, 3)) << "the wall before it";
}

}  // namespace tdpt::draw::section_test
