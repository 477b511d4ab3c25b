// The four stages that find portals, run as programs on rooms with known openings: a short version
// of portals_bench, with seeds that the method was not developed on. The scenes of the paper are
// too large for the repository: where they are absent their tests say so and are skipped.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/known_rooms.h"
#include "libcommon/testing/rooms/plan_walls.h"
#include "libcommon/testing/rooms/portal_score.h"
#include "libcommon/testing/rooms/portal_stages.h"

namespace tdpt::testing::pipeline_test {
namespace fs = std::filesystem;

const std::string kPaper = TDPT_SHARED "/scenes/";

StagesRun portals_of(const KnownRoom& room, const Writing& writing) {
  const TempFolder folder;
  folder.write("room.glb", room.plan.glb(writing));
  return run_stages({TDPT_BIN, {}, 2, room.sky}, (folder.path / "room").string());
}

// ---- Generated rooms ----
void expect_right(const KnownRoom& room) {
  const StagesRun run = portals_of(room, room.writing);
  ASSERT_FALSE(run.failed) << run.said;
  const PortalScore s = score(run.portals, room.placed_apertures());
  EXPECT_TRUE(s.right()) << room.file() << ": " << s.portals << " portals for " << s.openings
                         << ", " << s.strays << " strays, coverage " << s.coverage << ", tightness "
                         << s.tightness << ", angle " << s.angle << "\n"
                         << run.said;
}

// A slanting prism, too, would contain this light, with less etendue; its faces show that it is
// none.
TEST(known_portals, of_a_leaf_ajar_are_planes_not_prisms) {
  expect_right(known_room(RoomKind::ajar_full, 4001));
}
TEST(known_portals, of_a_bay_are_right) {
  expect_right(known_room(RoomKind::bay, 2001));
}
TEST(known_portals, of_windows_behind_a_door_are_right) {
  expect_right(known_room(RoomKind::room_behind, 2001));
}
TEST(long_known_portals, of_other_rooms_are_right) {
  for (const RoomKind kind :
       {RoomKind::hole, RoomKind::slit, RoomKind::floor_door, RoomKind::through_floor,
        RoomKind::ajar_full, RoomKind::window, RoomKind::two_openings, RoomKind::holes_in_row,
        RoomKind::doors_in_row, RoomKind::arch, RoomKind::windows_in_row, RoomKind::sky_windows,
        RoomKind::deep_room})
    expect_right(known_room(kind, 2001));
  // Slats outside the wall, windows that almost meet in a corner, windows with a narrow pier
  // between.
  expect_right(known_room(RoomKind::sky_blinds, 714));
  expect_right(known_room(RoomKind::corner_windows, 715));
  expect_right(known_room(RoomKind::sky_windows, 717));
}

void expect_none(RoomKind kind) {
  const KnownRoom room = known_room(kind, 2001);
  const StagesRun run = portals_of(room, room.writing);
  EXPECT_FALSE(run.failed);
  EXPECT_TRUE(run.portals.empty());
  EXPECT_NE(run.said.find("portalfit: no "), std::string::npos) << run.said;
}
TEST(known_portals, of_a_landscape_are_none_and_it_says_so) {
  expect_none(RoomKind::landscape);
}
TEST(long_known_portals, of_an_open_room_are_none_and_it_says_so) {
  expect_none(RoomKind::open_room);
}

// ---- What stands in an opening is part of it. An opening to a black outside is none. ----
using Stuff = RoomPlan::Stuff;

constexpr double kRim = 0.002;  // into the wall, so that no light passes beside

// A window in a wall across x; light passes it towards -x.
struct Window {
  KnownRoom room;
  Vec3d low{INFINITY}, high{-INFINITY};  // in the middle of the wall

  explicit Window(RoomKind kind) : room(known_room(kind, 3001)) {
    for (const Vec3d& p : room.apertures[0].outline) low = min(low, p), high = max(high, p);
  }
  // With one more box in it, from `a` to `b` of its width.
  void add(Stuff stuff, double thick, double a = 0, double b = 1) {
    const double z0 = low.z + (high.z - low.z) * a, z1 = low.z + (high.z - low.z) * b;
    room.plan.parts.push_back({"filling", 0,
                               box({low.x - 0.5 * thick, low.y - kRim, z0 - kRim},
                                   {high.x + 0.5 * thick, high.y + kRim, z1 + kRim}),
                               stuff});
  }
  // With a sheet, `before` the middle of the wall.
  void hang(Stuff stuff, double before, double beyond) {
    const double x = low.x - before, y0 = low.y - beyond, y1 = high.y + beyond, z0 = low.z - beyond,
                 z1 = high.z + beyond;
    room.plan.parts.push_back(
        {"filling", 0, {{{{x, y0, z0}, {x, y0, z1}, {x, y1, z1}, {x, y1, z0}}}}, stuff});
  }
};

TEST(filled_openings, with_a_solid_pane_have_their_portal) {
  Window window(RoomKind::window);
  window.add(Stuff::glass, 0.01);
  expect_right(window.room);
  Window board(RoomKind::window);  // twin: a board instead of the pane
  board.add(Stuff::board, 0.01);
  EXPECT_TRUE(portals_of(board.room, board.room.writing).portals.empty());
}

TEST(long_filled_openings, with_a_thin_pane_under_a_sky_have_their_portal) {
  Window window(RoomKind::sky_window);
  window.hang(Stuff::sheet, 0, kRim);
  expect_right(window.room);
}

TEST(long_filled_openings, behind_thin_curtains_have_their_portal) {
  Window window(RoomKind::window);
  window.hang(Stuff::cloth, 0.5 * window.room.apertures[0].thickness + 0.05, 0.1);
  expect_right(window.room);
}

TEST(long_filled_openings, with_a_grille_have_one_portal) {
  Window window(RoomKind::window);
  constexpr int kBars = 8;
  constexpr double kWide = 0.012;
  for (int k = 1; k <= kBars; ++k) {
    const double middle = double(k) / (kBars + 1),
                 half = 0.5 * kWide / (window.high.z - window.low.z);
    window.add(Stuff::board, kWide, middle - half, middle + half);
    const auto& bar = window.room.plan.parts.back().quads;
    auto& obstacles = window.room.apertures[0].obstacles;
    obstacles.insert(obstacles.end(), bar.begin(), bar.end());
  }
  expect_right(window.room);
}

// A hole in the wall at x = 0, behind the camera.
void pierce_end_wall(RoomPlan& plan) {
  for (RoomPlan::Part& part : plan.parts)
    for (auto wall = part.quads.begin(); wall != part.quads.end(); ++wall) {
      Vec3d low(INFINITY), high(-INFINITY);
      for (const Vec3d& p : *wall) low = min(low, p), high = max(high, p);
      if (low.x != 0 || high.x != 0) continue;
      part.quads.erase(wall);
      const Wall end = wall_between({-1, -0.1, low.y, high.y, low.z, high.z},
                                    {0, 1, low.y, high.y, low.z, high.z});
      const double middle = 0.5 * (high.z - low.z);
      append(part.quads, pierced(end, {{0.8, 1.6, middle - 0.4, middle + 0.4}}));
      return;
    }
}

TEST(filled_openings, to_a_black_outside_are_none) {
  KnownRoom room = known_room(RoomKind::window, 3001);
  pierce_end_wall(room.plan);
  expect_right(room);
}
TEST(long_filled_openings, twin_to_a_sky_are_some) {
  KnownRoom room = known_room(RoomKind::window, 3001);
  pierce_end_wall(room.plan);
  room.sky = "--environment 3,3,3";
  EXPECT_EQ(portals_of(room, room.writing).portals.size(), 2u);
}

// ---- Scenes of files ----
// `seed`: of the light grid.
std::vector<Portal> find_portals(const std::string& scene, int seed = 1) {
  const TempFolder folder;
  const std::string stem = (folder.path / "room").string();
  fs::create_symlink(fs::absolute(scene), stem + ".glb");
  const StagesRun run =
      run_stages({TDPT_BIN, {{"lightgrid", "--seed " + std::to_string(seed)}}, 2}, stem);
  EXPECT_FALSE(run.failed) << scene << ": " << run.said;
  return run.portals;
}

#define NEEDS(scene) \
  if (!fs::exists(scene)) GTEST_SKIP() << scene << " is not beside the project"

struct Box {
  Vec3d low, high;
};
bool inside(const Box& box, const Portal& portal) {
  return std::all_of(portal.vertices.begin(), portal.vertices.end(), [&](const Vec3d& v) {
    return min(v, box.low) == box.low && max(v, box.high) == box.high;
  });
}

void shift(std::vector<Portal>& portals, const Vec3d& by) {
  for (Portal& portal : portals)
    for (Vec3d& v : portal.vertices) v += by;
}

// The first portal lies within `bounds`, and together they cover the opening. Twins: `beside`, or
// reversed, they do not.
void expect_portal_in(const std::string& scene, const KnownAperture& opening, const Box& bounds,
                      const Vec3d& beside) {
  constexpr double kCovered = 0.9;
  std::vector<Portal> portals = find_portals(scene);
  ASSERT_GE(portals.size(), 1u);
  EXPECT_GE(coverage(opening, portals), kCovered);
  EXPECT_LE(degrees_between(mean_normal(portals[0]), opening.normal), 5);
  EXPECT_TRUE(inside(bounds, portals[0]));
  shift(portals, beside);
  EXPECT_LT(coverage(opening, portals), kCovered);
  shift(portals, -beside);
  for (Portal& portal : portals)
    for (auto& t : portal.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(coverage(opening, portals), 0);
}

TEST(pipeline, two_rooms_have_their_portal_in_the_hole) {
  expect_portal_in(TDPT_TESTDATA "/scenes/two-rooms.glb",
                   rectangle({2.05, 0.875, -0.125}, {0, 0.25, 0}, {0, 0, 0.25}, {-1, 0, 0}, 0.1),
                   {{2, 0.865, -0.135}, {2.1, 1.135, 0.135}}, {0, 0.1, 0});
}
TEST(long_pipeline, cornell_box_has_its_portal_in_the_hole) {
  NEEDS(kPaper + "cornell-box-portal.glb");
  expect_portal_in(kPaper + "cornell-box-portal.glb",
                   rectangle({1.01, 0.75, -0.25}, {0, 0.5, 0}, {0, 0, 0.5}, {-1, 0, 0}, 0.02),
                   {{0.98, 0.73, -0.27}, {1.04, 1.27, 0.27}}, {0, 0.2, 0});
}
TEST(pipeline, bathroom_has_its_portal_in_the_channel_of_the_window) {
  NEEDS(kPaper + "bathroom2-channel.glb");
  expect_portal_in(kPaper + "bathroom2-channel.glb",
                   rectangle({-6.039, 16, -26.7}, {8.731, 0, 0}, {0, 10.413, 0}, {0, 0, 1}, 8),
                   {{-6.2, 15.8, -31}, {2.9, 26.6, -22}}, {3, 0, 0});
}

// Its lamps are in their own opening; nearly a third of the light comes straight from them, which
// few walks may measure as a quarter.
TEST(long_pipeline, a_furnished_room_whose_lamps_are_seen_has_no_portal) {
  NEEDS(kPaper + "interiors/living-room-lamps.glb");
  EXPECT_TRUE(find_portals(kPaper + "interiors/living-room-lamps.glb").empty());
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
  // The slit was measured by eye: single seeds cover 0.77 to 0.91 of it.
  std::sort(covered.begin(), covered.end());
  EXPECT_GE(covered[covered.size() / 2], 0.8);
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

}  // namespace tdpt::testing::pipeline_test
