#include "libcommon/draw/storeys.h"

#include <gtest/gtest.h>

#include "libcommon/testing/scenes/box_house.h"

namespace tdpt::draw::storeys_test {

std::vector<Storey> found(const TestHouse& house) {
  const Tracer tracer(house.scene);
  return storeys_of(house.scene, tracer);
}

TEST(storeys, two_are_found_in_a_house_of_two) {
  const auto storeys = found(test_house(2));
  ASSERT_EQ(storeys.size(), 2u);
  EXPECT_NEAR(*storeys[0].floor, 0, 1e-3);
  EXPECT_NEAR(*storeys[1].floor, 2.8, 1e-3);
  EXPECT_NEAR(storeys[0].cut, 1.5, 1e-3);
  EXPECT_NEAR(storeys[1].cut, 4.3, 1e-3);
  EXPECT_NEAR(storeys[0].top, 2.75, 1e-3);
  EXPECT_FALSE(storeys[0].air.empty());
  EXPECT_EQ(found(test_house(1)).size(), 1u);
  EXPECT_EQ(found(test_house(3)).size(), 3u);
}

TEST(storeys, furniture_and_landings_are_none) {
  TestHouse h = test_house(2);
  h.box({1, 0, 1}, {3, 0.45, 3});       // a bed, above which one can stand
  h.box({5, 0, 1}, {6, 0.75, 2});       // a table
  h.box({6, 1.2, 4}, {7.7, 1.4, 5.7});  // a landing
  EXPECT_EQ(found(h).size(), 2u);
}

TEST(storeys, terrain_a_hundred_times_larger_changes_nothing) {
  TestHouse h = test_house(2);
  const auto alone = found(h);
  h.box({-400, -4, -300}, {400, -0.3, 300});  // no cellar, though hollow
  const auto within = found(h);
  ASSERT_EQ(within.size(), alone.size());
  for (size_t k = 0; k < alone.size(); ++k) {
    EXPECT_EQ(*within[k].floor, *alone[k].floor);
    EXPECT_LT(length(within[k].low - alone[k].low), 0.6) << "a wall more or less";
    EXPECT_LT(length(within[k].high - alone[k].high), 0.6);
    EXPECT_LT(within[k].high.x - within[k].low.x, 8 + 2);
    EXPECT_GT(within[k].high.x - within[k].low.x, 8);
  }
}

TEST(storeys, a_plane_without_ceiling_is_shown_as_a_whole) {
  TestHouse h;
  h.box({0, 0, 0}, {10, 1, 5});
  EXPECT_TRUE(found(h).empty());
  const Tracer tracer(h.scene);
  const auto drawn = storeys_to_draw(h.scene, tracer, {5, 3, 2}, {{1, 0.2, 1}, {1, 0.6, 1}});
  ASSERT_EQ(drawn.size(), 1u);
  EXPECT_FALSE(drawn[0].floor);
  EXPECT_NEAR(drawn[0].cut, 0.4, 1e-9);
  EXPECT_LT(drawn[0].low.x, 0);
  EXPECT_GT(drawn[0].high.z, 5);
}

TEST(storeys, those_of_the_camera_and_of_places_are_drawn_and_those_between) {
  const TestHouse h = test_house(4);
  const Tracer tracer(h.scene);
  const auto floors = [&](const Vec3d& camera, const std::vector<Vec3d>& places) {
    std::vector<long> all;
    for (const Storey& s : storeys_to_draw(h.scene, tracer, camera, places))
      all.push_back(std::lround(*s.floor / 2.8));
    return all;
  };
  EXPECT_EQ(floors({2, 4.4, 2}, {}), (std::vector<long>{1}));
  EXPECT_EQ(floors({2, 4.4, 2}, {{2, 7, 2}}), (std::vector<long>{1, 2}));
  EXPECT_EQ(floors({2, 7, 2}, {{2, 1, 2}}), (std::vector<long>{0, 1, 2}));
  // A single one of many places is not worth a plan.
  std::vector<Vec3d> many(100, {2, 1, 2});
  many.push_back({2, 10, 2});
  EXPECT_EQ(floors({2, 1, 2}, many), (std::vector<long>{0}));
}

}  // namespace tdpt::draw::storeys_test
