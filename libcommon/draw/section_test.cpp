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

// What fills places of a house, seen from 1 m around it in cells of 2 cm.
class Cut {
 public:
  explicit Cut(const TestHouse& house, std::vector<Vec3d> air = {{2, 1.5, 3}, {6, 1.5, 3}})
      : cells_(filled(house.scene, section(house.scene, 1.5), kGrid, air, 1.2)) {}
  Filled at(double x, double z) const {
    return cells_[static_cast<size_t>((x - kGrid.low_x) / kGrid.cell) +
                  static_cast<size_t>(kGrid.columns) *
                      static_cast<size_t>((z - kGrid.low_z) / kGrid.cell)];
  }

 private:
  static constexpr CellGrid kGrid{-1, -1, 0.02, 500, 400};
  std::vector<Filled> cells_;
};

TEST(filled, walls_are_and_rooms_and_doorways_are_not) {
  const Cut cut(test_house(1));
  for (const auto& [x, z] : {std::pair(0.15, 3.0), std::pair(7.85, 1.0), std::pair(5.0, 0.15),
                             std::pair(4.1, 1.0), std::pair(4.1, 5.0)})
    EXPECT_EQ(cut.at(x, z), Filled::wall) << x << ' ' << z;
  EXPECT_EQ(cut.at(0.15, 0.15), Filled::wall) << "where two walls overlap";
  for (const auto& [x, z] : {std::pair(2.0, 3.0), std::pair(6.0, 1.0), std::pair(-0.5, 3.0),
                             std::pair(4.1, 2.1), std::pair(4.1, 2.8)})
    EXPECT_EQ(cut.at(x, z), Filled::air) << x << ' ' << z;
}

TEST(filled, twin_a_wall_without_a_doorway_has_no_gap) {
  EXPECT_EQ(Cut(test_house(1, false)).at(4.1, 2.45), Filled::wall);
}

TEST(filled, an_open_sheet_spoils_nothing) {
  TestHouse h = test_house(1);
  h.quad({2, 0, 2}, {2, 2.5, 2}, {2, 2.5, 4}, {2, 0, 4});
  const Cut cut(h, {{1, 1.5, 3}, {3, 1.5, 3}, {6, 1.5, 3}, {6, 1.5, 1}});
  EXPECT_EQ(cut.at(1, 3), Filled::air);
  EXPECT_EQ(cut.at(3, 3), Filled::air);
  EXPECT_EQ(cut.at(0.15, 3), Filled::wall);
  EXPECT_EQ(cut.at(4.1, 3.5), Filled::wall);
}

TEST(filled, no_earth_behind_a_sheet_or_before_a_room_without_a_front) {
  TestHouse h = test_house(1);
  h.quad({2, 0, 3}, {6, 2, 3}, {6, 2, 3.01}, {2, 0, 3.01});  // aslant, one-sided
  const Cut cut(h, {{2, 1.5, 1}, {6, 1.5, 1}, {2, 1.5, 5}, {6, 1.5, 5}});
  for (const double z : {-0.5, 6.5}) EXPECT_EQ(cut.at(4, z), Filled::air);
  TestHouse open;
  open.quad({0, 0, 0}, {8, 0, 0}, {8, 2.5, 0}, {0, 2.5, 0});
  open.quad({0, 0, 6}, {0, 0, 0}, {0, 2.5, 0}, {0, 2.5, 6});
  open.quad({8, 0, 0}, {8, 0, 6}, {8, 2.5, 6}, {8, 2.5, 0});
  for (const double z : {-0.5, 6.5}) EXPECT_EQ(Cut(open).at(4, z), Filled::air);
}

TEST(filled, between_rooms_without_outer_sides_is_a_wall) {
  TestHouse h;
  h.box({0, 0, 0}, {3.9, 2.5, 6}, false);
  h.box({4.1, 0, 0}, {8, 2.5, 6}, false);
  const Cut cut(h);
  EXPECT_EQ(cut.at(4, 3), Filled::wall);
  EXPECT_EQ(cut.at(2, 3), Filled::air);
}

TEST(filled, a_body_thicker_than_a_wall_is_earth) {
  TestHouse h = test_house(1);
  h.box({-0.9, -1, -5}, {0, 2.5, 12});  // 0.9 m are a wall still
  EXPECT_EQ(Cut(h).at(-0.5, 3), Filled::wall);
  h.box({8, -1, -5}, {12, 2.5, 12});
  EXPECT_EQ(Cut(h).at(8.5, 3), Filled::earth);
  EXPECT_EQ(Cut(h).at(7.85, 3), Filled::wall) << "the wall before it";
}

TEST(filled, nothing_where_the_places_in_the_air_contradict_each_other) {
  const Cut cut(test_house(1), {{2, 1.5, 3}, {0.15, 1.5, 3}});
  EXPECT_EQ(cut.at(4.1, 1), Filled::air);
}

}  // namespace tdpt::draw::section_test
