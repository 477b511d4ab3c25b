// What stands in an opening is part of it: panes, curtains and bars. An opening to a black outside
// is none.
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/known_rooms.h"
#include "libcommon/testing/rooms/portal_score.h"
#include "libcommon/testing/rooms/portal_stages.h"

namespace tdpt::testing::filled_openings_test {

using Stuff = RoomPlan::Stuff;

constexpr double kRim = 0.002;  // into the wall, so that no light passes beside

StagesRun portals_of(const KnownRoom& room) {
  const TempFolder folder;
  std::ofstream(folder.path / "room.glb", std::ios::binary) << room.plan.glb(room.writing);
  return run_stages({TDPT_BIN, {}, 2, room.sky}, (folder.path / "room").string());
}

void expect_right(const KnownRoom& room) {
  const StagesRun run = portals_of(room);
  ASSERT_FALSE(run.failed);
  const PortalScore s = score(run.portals, room.placed_apertures());
  EXPECT_TRUE(s.right()) << s.portals << " portals for " << s.openings << ", coverage "
                         << s.coverage << ", tightness " << s.tightness << ", angle " << s.angle
                         << "\n"
                         << run.said;
}

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
  EXPECT_TRUE(portals_of(board.room).portals.empty());
}

TEST(long_filled_openings, with_a_thin_pane_have_their_portal) {
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
      const std::vector<Quad> pierced =
          wall_across_x(-0.1, 0, {low.y, high.y, low.z, high.z}, {{0.8, 1.6, -0.4, 0.4}}, true);
      part.quads.insert(part.quads.end(), pierced.begin(), pierced.end());
      return;
    }
}

TEST(filled_openings, to_a_black_outside_are_none) {
  KnownRoom room = known_room(RoomKind::window, 3001);
  pierce_end_wall(room.plan);
  expect_right(room);
  room.sky = "--environment 3,3,3";  // twin: under a sky it is one
  EXPECT_EQ(portals_of(room).portals.size(), 2u);
}

}  // namespace tdpt::testing::filled_openings_test
