#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <gtest/gtest.h>

#include "tools/portalfit/opening.h"
#include "tools/portalfit/portalfit.h"
#include "tools/portalfit/testing/openings.h"

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

using testing::Opening;

// 1 x 1 m, in the wall x = 0 and in the wall y = 0; their near edges 0.3 m from the corner.
const Opening kOne{{0, -0.8, 0}, {0, 0.5, 0}, {0, 0, 0.5}, {-1, 0, 0}, 0, 0.5};
const Opening kOther{{-0.8, 0, 0}, {0.5, 0, 0}, {0, 0, 0.5}, {0, -1, 0}, 0, 0.5};

Aperture rectangle(const LightGrid& grid, const Opening& w) {
  Aperture a;
  a.tube.middle = {w.middle, w.n};
  a.tube.half = 0.5 * grid.voxel;
  for (const Vec3d& p : {-w.u - w.v, w.u - w.v, w.u + w.v, w.v - w.u})
    a.polygon.push_back(in_plane(a.tube.middle, w.middle + p));
  a.polygon = convex_hull(a.polygon);
  a.lines = lines_across(testing::all_of(grid), a);
  return a;
}

// A plane across the corner, before both windows, lies in the open; twin: a window does not.
TEST(Directions, PartThePlaneBeforeTwoWindowsAtACorner) {
  const LightGrid grid = testing::grid_of(testing::lines_through({kOne, kOther}, 3000));
  const double c = std::sqrt(0.5);
  const Opening across{{-0.65, -0.65, 0}, Vec3d{c, -c, 0} * 0.92, {0, 0, 1}, {-c, -c, 0}};
  const auto part = part_of_directions(grid, testing::all_of(grid), rectangle(grid, across));
  ASSERT_TRUE(part);
  const Plane& found = part->tube.middle;
  const Opening& of = found.n.x < -0.5 ? kOne : kOther;
  EXPECT_GT(dot(found.n, of.n), std::cos(0.06));
  EXPECT_NEAR(dot(found.o - of.middle, of.n), 0, 0.1);
  EXPECT_NEAR(area(part->polygon), 1, 0.12);
  EXPECT_FALSE(part_of_directions(grid, testing::all_of(grid), rectangle(grid, kOne)));
}

}  // namespace tdpt::outline_test
