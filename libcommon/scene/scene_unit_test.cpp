#include "libcommon/scene/scene_unit.h"

#include <gtest/gtest.h>

#include <string>

namespace tdpt::scene_unit_test {

// A floor and ceilings above it, each over a place on the x axis with a camera 1.6 m high; all
// times `scale`.
Scene rooms(const std::vector<double>& heights, double scale) {
  Scene scene;
  scene.frame.scale = 1 / (1000 * scale);  // canonical: within [-1, 1]
  const auto add = [&](double x, double y) {
    const auto first = static_cast<uint32_t>(scene.positions.size());
    for (const auto& [dx, dz] : {std::pair(-2, -2), {2, -2}, {0, 3}})
      scene.positions.push_back(
          Vec3f(scene.frame.to_canonical(Vec3d{x + dx, y, 1.0 * dz} * scale)));
    scene.triangles.push_back({{first, first + 1, first + 2}, 0});
  };
  for (size_t i = 0; i < heights.size(); ++i) {
    const double x = 10.0 * static_cast<double>(i);
    add(x, 0);
    if (heights[i] > 0) add(x, heights[i]);
    scene.cameras.emplace_back().position = scene.frame.to_canonical(Vec3d{x, 1.6, 0} * scale);
  }
  return scene;
}

std::string unit(const std::vector<double>& heights, double scale) {
  const auto told = unit_of(rooms(heights, scale));
  return told ? told->name : "metres";
}

TEST(scene_unit, is_told_by_rooms_from_low_to_high) {
  for (const double height : {1.8, 2.2, 2.7, 3.5, 4.2}) {
    EXPECT_EQ(unit({height}, 100), "centimetres") << height;
    EXPECT_EQ(unit({height}, 39.37), "inches") << height;
    EXPECT_EQ(unit({height}, 1000), "millimetres") << height;
  }
}

TEST(scene_unit, is_not_told_of_metres_nor_without_ceilings) {
  for (const double height : {1.8, 2.7, 12.0, 40.0}) EXPECT_EQ(unit({height}, 1), "metres");
  EXPECT_EQ(unit({0}, 100), "metres") << "no ceiling";
  Scene scene = rooms({2.7}, 100);
  scene.cameras.clear();
  EXPECT_FALSE(unit_of(scene)) << "nobody is in it";
}

TEST(scene_unit, is_not_changed_by_one_hall_or_shelf) {
  EXPECT_EQ(unit({2.5, 80, 3}, 1), "metres");
  EXPECT_EQ(unit({2.5, 0.4, 3}, 100), "centimetres") << "one camera stands under a shelf";
}

}  // namespace tdpt::scene_unit_test
