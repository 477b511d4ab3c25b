// The four stages that find portals, run as programs on rooms with known openings. The scenes of
// the paper are too large for the repository: where they are absent their tests say so and are
// skipped.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>

#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/known_rooms.h"
#include "libcommon/testing/rooms/portal_score.h"
#include "libcommon/testing/rooms/portal_stages.h"
#include "libcommon/testing/rooms/room_scene.h"

namespace tdpt::testing::pipeline_test {
namespace fs = std::filesystem;

const std::string kOwn = TDPT_TESTDATA "/scenes/", kPaper = TDPT_SHARED "/scenes/";

// `seed`: of the light grid.
std::vector<Portal> find_portals(const std::string& scene, int seed = 1) {
  const TempFolder folder;
  const std::string stem = (folder.path / "room").string();
  fs::create_symlink(fs::absolute(scene), stem + ".glb");
  const StagesRun run =
      run_stages({.bin = TDPT_BIN,
                  .options = {{"lightgrid", "--seed " + std::to_string(seed)}},
                  .threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))},
                 stem);
  EXPECT_FALSE(run.failed) << scene << ": " << run.said;
  return run.portals;
}

// A room of this depth, 4 x 2.6 m, whose end wall at x = depth is missing; if `wide` is more than
// 4, a frame with a hole `wide` m wide stands behind it. On a ground, under a sky.
RoomPlan room_open_to_the_sky(double depth, double wide) {
  constexpr double kHigh = 2.6, kHalf = 2, t = 0.15;
  RoomPlan plan;
  const auto wall = [&](const Vec3d& low, const Vec3d& high) {
    plan.parts.push_back({"wall", 0, box(low, high)});
  };
  wall({-t, -t, -kHalf - t}, {depth, 0, kHalf + t});
  wall({-t, kHigh, -kHalf - t}, {depth, kHigh + t, kHalf + t});
  wall({-t, 0, -kHalf - t}, {0, kHigh, kHalf + t});
  for (const double z : {-kHalf - t, kHalf}) wall({0, 0, z}, {depth, kHigh, z + t});
  if (wide > 2 * kHalf) {
    const double side = 0.5 * wide, beyond = depth + 2 * t;
    wall({depth, kHigh, -side - 1}, {beyond, kHigh + 1, side + 1});
    wall({depth, -t, -side - 1}, {beyond, 0, side + 1});
    for (const double way : {-1.0, 1.0}) {
      wall({depth, 0, std::min(way * side, way * (side + 1))},
           {beyond, kHigh, std::max(way * side, way * (side + 1))});
      wall({depth - t, 0, std::min(way * kHalf, way * (side + 1))},
           {depth, kHigh, std::max(way * kHalf, way * (side + 1))});
    }
  }
  plan.parts.push_back(
      {"ground", 0, {{{{-20, -t, 20}, {20, -t, 20}, {20, -t, -20}, {-20, -t, -20}}}}});
  plan.camera = {0.4, 1.5, -1.2}, plan.look_at = {depth, 1.1, 0.6};
  return plan;
}

StagesRun under_a_sky(const std::string& glb, const std::string& sky = "--environment 1,1,1") {
  const TempFolder folder;
  const std::string stem = (folder.path / "room").string();
  std::ofstream(stem + ".glb", std::ios::binary) << glb;
  return run_stages({.bin = TDPT_BIN,
                     .threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency())),
                     .sky = sky},
                    stem);
}

#define NEEDS(scene) \
  if (!fs::exists(scene)) GTEST_SKIP() << scene << " is not beside the project"

struct Box {
  Vec3d low, high;
};
bool inside(const Box& box, const Portal& portal) {
  for (const Vec3d& v : portal.vertices)
    if (min(v, box.low) != box.low || max(v, box.high) != box.high) return false;
  return true;
}

void shift(std::vector<Portal>& portals, const Vec3d& by) {
  for (Portal& portal : portals)
    for (Vec3d& v : portal.vertices) v += by;
}

TEST(pipeline, two_rooms_have_their_portal_in_the_hole) {
  const KnownAperture hole =
      rectangle({2.05, 0.875, -0.125}, {0, 0.25, 0}, {0, 0, 0.25}, {-1, 0, 0}, 0.1);
  std::vector<Portal> portals = find_portals(kOwn + "two-rooms.glb");
  ASSERT_EQ(portals.size(), 1u);
  EXPECT_GE(coverage(hole, portals), 0.95);
  EXPECT_LE(degrees_between(mean_normal(portals[0]), hole.normal), 3);
  EXPECT_TRUE(inside({{2, 0.865, -0.135}, {2.1, 1.135, 0.135}}, portals[0]));
  // Twins: the score detects a portal that is beside the hole or reversed.
  std::vector<Portal> beside = portals;
  shift(beside, {0, 0.1, 0});
  EXPECT_LT(coverage(hole, beside), 0.7);
  for (auto& t : portals[0].triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(coverage(hole, portals), 0);
}

// A pane of 1 cm in the hole: glass lets light through, a board does not.
TEST(pipeline, a_glass_pane_does_not_wall_the_hole_up) {
  const auto rooms_with_pane = [](double transmission) {
    RoomScene s;
    s.b.json["extensionsUsed"].push_back("KHR_materials_transmission");
    s.row(2, {0.875, 1.125, -0.125, 0.125});
    s.ceiling_lamp(3.1, 20);
    s.b.camera("camera", {0.15, 1.25, 0.75}, {2, 0.8, -0.25}, kFov, kAspect);
    const int glass = s.b.material(
        {{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
         {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", transmission}}}}}});
    Quads pane;
    for (double x : {2.045, 2.055})
      pane.add({x, 0.875, 0.125}, {x, 0.875, -0.125}, {x, 1.125, -0.125}, {x, 1.125, 0.125});
    s.part("pane", glass, pane);
    const TempFolder folder;
    return find_portals(folder.write("pane.glb", s.b.glb()));
  };
  const KnownAperture hole =
      rectangle({2.05, 0.875, -0.125}, {0, 0.25, 0}, {0, 0, 0.25}, {-1, 0, 0}, 0.1);
  EXPECT_GE(coverage(hole, rooms_with_pane(1)), 0.9);
  EXPECT_TRUE(rooms_with_pane(0).empty());  // twin: a board
}

// A pane of solid glass, 2 cm thick, in the middle of the hole.
TEST(pipeline, a_portal_stands_in_the_air_before_solid_glass) {
  RoomScene s;
  for (const char* name : {"KHR_materials_transmission", "KHR_materials_volume"})
    s.b.json["extensionsUsed"].push_back(name);
  s.row(2, {0.875, 1.125, -0.125, 0.125});
  s.ceiling_lamp(3.1, 20);
  s.b.camera("camera", {0.15, 1.25, 0.75}, {2, 0.8, -0.25}, kFov, kAspect);
  const int glass = s.b.material({{"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                                  {"extensions",
                                   {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                                    {"KHR_materials_volume", {{"thicknessFactor", 1}}}}}});
  constexpr double kFront = 2.04, kBack = 2.06;
  Quads pane;
  for (const RoomPlan::Quad& q : box({kFront, 0.875, -0.125}, {kBack, 1.125, 0.125}))
    pane.add(q[0], q[1], q[2], q[3]);
  s.part("pane", glass, pane);
  const TempFolder folder;
  const std::vector<Portal> portals = find_portals(folder.write("pane.glb", s.b.glb()));
  const KnownAperture hole =
      rectangle({2.05, 0.875, -0.125}, {0, 0.25, 0}, {0, 0, 0.25}, {-1, 0, 0}, 0.1);
  ASSERT_EQ(portals.size(), 1u);
  EXPECT_GE(coverage(hole, portals), 0.95);
  for (const Vec3d& corner : portals[0].vertices)
    EXPECT_TRUE(corner.x < kFront || corner.x > kBack) << corner.x;
}

TEST(pipeline, rooms_in_a_row_have_a_portal_in_each_of_their_doors) {
  const KnownAperture first =
      rectangle({2.05, 0.75, -0.25}, {0, 0.5, 0}, {0, 0, 0.5}, {-1, 0, 0}, 0.1);
  const KnownAperture second =
      rectangle({4.15, 0.75, -0.25}, {0, 0.5, 0}, {0, 0, 0.5}, {-1, 0, 0}, 0.1);
  const std::vector<Portal> portals = find_portals(kOwn + "three-rooms.glb");
  const PortalScore found = score(portals, {first, second});
  EXPECT_TRUE(found.right_number()) << portals.size();
  EXPECT_GE(found.coverage, 0.95);
  EXPECT_GE(found.tightness, 0.9);
  EXPECT_LE(found.angle, 4);
  // Twin: one of the two is not enough.
  EXPECT_LT(score({portals[0]}, {first, second}).coverage, 0.2);
}

TEST(pipeline, a_single_room_has_no_portal) {
  EXPECT_TRUE(find_portals(kOwn + "furnace.glb").empty());
}

TEST(pipeline, a_room_without_a_wall_says_that_its_opening_is_wide) {
  for (const double wide : {4.0, 6.0}) {
    const StagesRun run = under_a_sky(room_open_to_the_sky(3, wide).glb());
    EXPECT_FALSE(run.failed);
    EXPECT_TRUE(run.portals.empty());
    EXPECT_NE(run.said.find("the opening is wide"), std::string::npos) << wide << " " << run.said;
  }
}

// Its lamps are in their own opening; nearly a third of the light comes straight from them, which
// few walks may measure as a quarter.
TEST(pipeline, a_furnished_room_whose_lamps_are_seen_has_no_portal) {
  const std::string scene = kPaper + "interiors/living-room-lamps.glb";
  NEEDS(scene);
  EXPECT_TRUE(find_portals(scene).empty());
}

// As wide as the room, but a bottleneck because the room is deep: the portal lies in the mouth.
TEST(long_pipeline, a_deep_room_has_its_portal_where_its_wall_is_missing) {
  const KnownAperture mouth = rectangle({9, 0, -2}, {0, 2.6, 0}, {0, 0, 4}, {-1, 0, 0}, 0);
  for (const double wide : {4.0, 6.0}) {
    std::vector<Portal> portals = under_a_sky(room_open_to_the_sky(9, wide).glb()).portals;
    ASSERT_EQ(portals.size(), 1u) << wide;
    EXPECT_GE(coverage(mouth, portals), 0.98) << wide;
    EXPECT_LE(degrees_between(mean_normal(portals[0]), mouth.normal), 3) << wide;
    EXPECT_TRUE(inside({{8.9, -0.1, -2.2}, {9.2, 2.7, 2.2}}, portals[0])) << wide;
    shift(portals, {-4.5, 0, 0});  // twin: across the middle of the room
    EXPECT_LT(coverage(mouth, portals), 0.5) << wide;
  }
}

// Slats outside the wall, windows that almost meet in a corner, windows with a narrow pier between.
void expect_a_portal_in_each_window(const std::vector<std::pair<RoomKind, uint64_t>>& rooms) {
  for (const auto& [kind, seed] : rooms) {
    const KnownRoom room = known_room(kind, seed);
    const StagesRun run = under_a_sky(room.plan.glb(room.writing), room.sky);
    const PortalScore found = score(run.portals, room.placed_apertures());
    EXPECT_TRUE(found.right()) << room.file() << " " << found.coverage << " " << found.tightness
                               << " " << found.angle << " " << run.said;
  }
}

TEST(pipeline, windows_under_a_sky_have_a_portal_each) {
  expect_a_portal_in_each_window({{RoomKind::sky_blinds, 714}});
}
TEST(long_pipeline, windows_under_a_sky_have_a_portal_each) {
  expect_a_portal_in_each_window(
      {{RoomKind::sky_blinds, 714}, {RoomKind::corner_windows, 715}, {RoomKind::sky_windows, 717}});
}

TEST(pipeline, cornell_box_has_its_portal_in_the_hole) {
  const std::string scene = kPaper + "cornell-box-portal.glb";
  NEEDS(scene);
  const KnownAperture hole =
      rectangle({1.01, 0.75, -0.25}, {0, 0.5, 0}, {0, 0, 0.5}, {-1, 0, 0}, 0.02);
  std::vector<Portal> portals = find_portals(scene);
  ASSERT_EQ(portals.size(), 1u);
  EXPECT_GE(coverage(hole, portals), 0.9);
  EXPECT_LE(degrees_between(mean_normal(portals[0]), hole.normal), 5);
  EXPECT_TRUE(inside({{0.98, 0.73, -0.27}, {1.04, 1.27, 0.27}}, portals[0]));
  shift(portals, {0, 0.2, 0});  // twin
  EXPECT_LT(coverage(hole, portals), 0.9);
}

// The leaf is hinged at z = -4.67 and open into the room, x > -2.82: light passes between its free
// edge and the frame at z = -6.28, and over its top. The slit was measured at half height: from the
// frame (-2.82, -6.29) to the leaf's edge (-2.38, -6.13).
void expect_portal_in_the_door(const std::string& scene, int seeds) {
  NEEDS(scene);
  const Vec3d across = Vec3d{-2.38, 0, -6.13} - Vec3d{-2.82, 0, -6.29};
  const KnownAperture slit = rectangle({-2.82, 0.1, -6.29}, across, {0, 2.5, 0},
                                       normalize(Vec3d{-across.z, 0, across.x}) * -1.0, 0);
  // The hull overshoots the frame (y = 2.77): up to 2.97..3.24 with seeds 1 to 4.
  const Box opening{{-3.05, -0.1, -6.5}, {-2.2, 3.3, -4.4}};
  std::vector<double> covered, beside;
  for (int seed = 1; seed <= seeds; ++seed) {
    std::vector<Portal> portals = find_portals(scene, seed);
    ASSERT_GE(portals.size(), 1u);
    for (const Portal& portal : portals)
      EXPECT_TRUE(inside(opening, portal)) << portal.name << ", seed " << seed;
    covered.push_back(coverage(slit, portals));
    shift(portals, across);  // twin: one slit width beside it
    beside.push_back(coverage(slit, portals));
  }
  const auto median = [](std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
  };
  // The slit was measured by eye: single seeds cover 0.77 to 0.91 of it.
  EXPECT_GE(median(covered), 0.8);
  EXPECT_LT(*std::max_element(beside.begin(), beside.end()), 0.8);
}
TEST(pipeline, veach_ajar_has_its_portals_in_the_doors_opening) {
  expect_portal_in_the_door(kPaper + "veach-ajar.glb", 1);
}
TEST(long_pipeline, veach_ajar_has_its_portals_in_the_doors_opening) {
  expect_portal_in_the_door(kPaper + "veach-ajar.glb", 5);
}
TEST(long_pipeline, veach_ajar_flip_has_its_portals_in_the_doors_opening) {
  expect_portal_in_the_door(kPaper + "veach-ajar-flip.glb", 5);
}

TEST(pipeline, bathroom_has_its_portal_in_the_channel_of_the_window) {
  const std::string scene = kPaper + "bathroom2-channel.glb";
  NEEDS(scene);
  const KnownAperture channel =
      rectangle({-6.039, 16, -26.7}, {8.731, 0, 0}, {0, 10.413, 0}, {0, 0, 1}, 8);
  std::vector<Portal> portals = find_portals(scene);
  ASSERT_GE(portals.size(), 1u);
  EXPECT_GE(coverage(channel, portals), 0.9);
  EXPECT_TRUE(inside({{-6.2, 15.8, -31}, {2.9, 26.6, -22}}, portals[0]));
  shift(portals, {3, 0, 0});  // twin
  EXPECT_LT(coverage(channel, portals), 0.9);
}

}  // namespace tdpt::testing::pipeline_test
