// Windows in several walls: openings told apart by the directions of their light.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <gtest/gtest.h>

#include "tools/portalfit/aperture.h"
#include "tools/portalfit/neighbours.h"
#include "tools/portalfit/portalfit.h"
#include "tools/portalfit/testing/bundle.h"
#include "tools/portalfit/testing/windows.h"

namespace tdpt::directions_test {

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
  const auto part = part_of_directions({grid, {}}, all_of(grid), rectangle(grid, diagonal()));
  ASSERT_TRUE(part);
  EXPECT_GE(window_of(*part, room.windows), 0);
}

// Twin: a window is no such plane.
TEST(Directions, PartNoWindow) {
  const LightGrid grid = RoomWithWindows{{kOne, kOther}}.light(6000, 0);
  EXPECT_FALSE(part_of_directions({grid, {}}, all_of(grid), rectangle(grid, kOne)));
}

TEST(Directions, LinesBesideAnOpeningAreThoseOfTheOthers) {
  const LightGrid grid = RoomWithWindows{{kOne, kOther}}.light(6000, 0);
  const auto own = lines_beside(all_of(grid), {rectangle(grid, kOne)}, {}).which;
  const auto other = rectangle(grid, kOther).lines.which;
  std::vector<uint32_t> of_other;
  std::set_intersection(own.begin(), own.end(), other.begin(), other.end(),
                        std::back_inserter(of_other));
  EXPECT_GT(of_other.size(), own.size() * 95 / 100);  // without the first window's grazing lines
  EXPECT_NEAR(static_cast<double>(own.size()), 3000, 300);
  EXPECT_EQ(lines_beside(all_of(grid), {}, {}).size(), 6000u);
}

}  // namespace tdpt::directions_test
