#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <gtest/gtest.h>

#include "tools/portalfit/opening.h"
#include "tools/portalfit/portalfit.h"
#include "tools/portalfit/testing/bundle.h"
#include "tools/portalfit/testing/windows.h"

namespace tdpt::outline_test {

// A square of 1 m across x, with walls around it: of a corridor from -2 to 2 m, or of a hole in a
// wall that is 0.2 m thick.
Aperture across_x(double from, double to, LightGrid& grid) {
  grid.voxel = 0.1;
  grid.dim = {40, 40, 40};
  grid.origin = Vec3d(-2);
  grid.air.assign(64000, 1);
  for (size_t v = 0; v < grid.air.size(); ++v) {
    const Vec3d at = centre_of(grid, v);
    const double off = std::max(std::abs(at.y), std::abs(at.z));
    if (at.x > from && at.x < to && off > 0.5 && off < 0.75) grid.air[v] = 0;
  }
  Aperture a;
  a.tube.middle = {{0, 0, 0}, {1, 0, 0}};
  a.polygon = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  return a;
}

TEST(Edge, TellsAHoleFromACorridor) {
  LightGrid hole, corridor, end;
  const Aperture through = across_x(-0.1, 0.1, hole), along = across_x(-2, 2, corridor),
                 out_of = across_x(-2, 0.1, end);
  EXPECT_EQ(edge_share(hole, through).value_or(0), 1);
  EXPECT_EQ(edge_share(corridor, along).value_or(1), 0);
  EXPECT_EQ(edge_share(end, out_of).value_or(0), 1);  // on one side
  // A door in the corridor's wall is not enough.
  for (size_t v = 0; v < corridor.air.size(); ++v) {
    const Vec3d at = centre_of(corridor, v);
    if (at.x > 0.2 && at.y > 0.5 && std::abs(at.z) < 0.4) corridor.air[v] = 1;
  }
  EXPECT_NEAR(edge_share(corridor, along).value_or(1), 0.2, 0.05);
  // Nor is a place in the open.
  const Aperture apart{{{{1, 0, 0}, {1, 0, 0}}}, through.polygon, {}};
  EXPECT_EQ(edge_share(hole, apart).value_or(1), 0);
  corridor.voxel = 0.3;  // too coarse to tell
  EXPECT_FALSE(edge_share(corridor, along));
  corridor.voxel = 0.1;
  corridor.air.assign(corridor.air.size(), 1);
  EXPECT_FALSE(edge_share(corridor, along));
}

// The wall around a window of 2.8 m reaches 0.5 m beyond it, less than a fifth of its size.
TEST(Edge, OfAWindowAlmostAsWideAsItsRooms) {
  LightGrid grid;
  Aperture window = across_x(0, 0, grid);
  const double half = 1.4;
  window.polygon = {{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  const auto build = [&](bool wall) {
    for (size_t v = 0; v < grid.air.size(); ++v) {
      const Vec3d at = centre_of(grid, v);
      const double off = std::max(std::abs(at.y), std::abs(at.z));
      grid.air[v] = wall ? off < (std::abs(at.x) < 0.1 ? half : half + 0.5) : off < half;
    }
  };
  build(true);
  EXPECT_EQ(edge_share(grid, window).value_or(0), 1);
  build(false);  // twin: rooms that end where the window does
  EXPECT_EQ(edge_share(grid, window).value_or(1), 0);
}

// Beyond the grid, as under a sky, all is open.
TEST(Edge, OfAWindowGoesOnOutsideTheGrid) {
  LightGrid grid;
  const Aperture window = across_x(-2, 2, grid);
  grid.origin.x = 0;
  EXPECT_EQ(edge_share(grid, window).value_or(0), 1);
}

// Windows in several walls: openings told apart by the directions of their light.

using testing::all_of;
using testing::RoomWithWindows;
using testing::Window;

// 1 x 1 m, in the wall x = 0 and in the wall y = 0; their near edges 0.3 m from the corner.
const Window kOne{{0, -0.8, 0}, {0, 0.5, 0}, {0, 0, 0.5}, {-1, 0, 0}};
const Window kOther{{-0.8, 0, 0}, {0.5, 0, 0}, {0, 0, 0.5}, {0, -1, 0}};
// In the wall x = -3, opposite the first.

Aperture rectangle(const LightGrid& grid, const Window& w) {
  Aperture a;
  a.tube.middle = {w.middle, w.n};
  a.tube.half = 0.5 * grid.voxel;
  for (const Vec3d& p : {-w.u - w.v, w.u - w.v, w.u + w.v, w.v - w.u})
    a.polygon.push_back(in_plane(a.tube.middle, w.middle + p));
  a.polygon = convex_hull(a.polygon);
  a.lines = lines_across(all_of(grid), a);
  return a;
}

// A plane across the corner, before both windows.
Window diagonal() {
  const double c = std::sqrt(0.5);
  return {{-0.65, -0.65, 0}, Vec3d{c, -c, 0} * 0.92, {0, 0, 1}, {-c, -c, 0}};
}

// Index of the window that an opening matches; -1: none.
int window_of(const Aperture& a, const std::vector<Window>& windows) {
  for (size_t k = 0; k < windows.size(); ++k)
    if (dot(a.tube.middle.n, windows[k].n) > std::cos(0.06) &&
        std::abs(dot(a.tube.middle.o - windows[k].middle, windows[k].n)) < 0.1 &&
        std::abs(area(a.polygon) - 1) < 0.12)
      return static_cast<int>(k);
  return -1;
}

TEST(Directions, PartThePlaneBeforeTwoWindowsAtACorner) {
  const RoomWithWindows room{{kOne, kOther}};
  const LightGrid grid = room.light(6000, 0);
  const auto part = part_of_directions(grid, all_of(grid), rectangle(grid, diagonal()));
  ASSERT_TRUE(part);
  EXPECT_GE(window_of(*part, room.windows), 0);
}

// Twin: a window is no such plane.
TEST(Directions, PartNoWindow) {
  const LightGrid grid = RoomWithWindows{{kOne, kOther}}.light(6000, 0);
  EXPECT_FALSE(part_of_directions(grid, all_of(grid), rectangle(grid, kOne)));
}

}  // namespace tdpt::outline_test
