#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "tools/portalfit/opening.h"
#include "tools/portalfit/testing/openings.h"

namespace tdpt::neighbours_test {

// 1 m x 1 m in the plane across z, centre at (x, 0, z), turned about the y axis.
Aperture pane(double x, double z = 0, double slope = 0) {
  Aperture a;
  a.tube.middle = {{x, 0, z}, normalize(Vec3d{slope, 0, 1})};
  const Onb<double> frame(a.tube.middle.n);
  const Vec3d along = normalize(Vec3d{1, 0, -slope});
  for (const auto& [u, v] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
    const Vec3d p = along * u + Vec3d{0, v, 0};
    a.polygon.push_back({dot(p, frame.x), dot(p, frame.y)});
  }
  a.polygon = convex_hull(a.polygon);
  return a;
}

constexpr double kVoxel = 0.05;

LightGrid empty_grid() {
  LightGrid grid;
  grid.voxel = kVoxel;
  return grid;
}

TEST(Joining, PanesInOnePlaneLeaveTheirShareOpen) {
  const Joint joint = joint_of(empty_grid(), {pane(0), pane(1.25)});
  EXPECT_TRUE(joint.flat);
  EXPECT_NEAR(area(joint.outline), 2.25, 1e-9);
  EXPECT_NEAR(joint.open, 2 / 2.25, 1e-9);
}

TEST(Joining, PanesOfABayAreNotFlat) {
  EXPECT_FALSE(joint_of(empty_grid(), {pane(0, 0, -0.6), pane(1, 0, 0.6)}).flat);
  EXPECT_FALSE(joint_of(empty_grid(), {pane(0), pane(1.25, 0.6)}).flat);  // one behind the other
  EXPECT_FALSE(joint_of(empty_grid(), {pane(0), pane(1, 0.5, 1)}).flat);
}

// Panes 1 m x 1 m side by side, `gap` between them, in a wall across z; lines through both. Returns
// the number after joining.
size_t left_of_two(double gap) {
  const testing::Opening first{{0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 1}, 0, 0.5};
  testing::Opening second = first;
  second.middle.x = 1 + gap;
  LightGrid g;
  g.lines = testing::lines_through({first, second}, 4000);
  std::vector<Aperture> panes{pane(0), pane(1 + gap)};
  const Bundle all = testing::all_of(g);
  for (Aperture& a : panes) a.lines = lines_across(all, a);
  return joined_in_planes(empty_grid(), all, panes, 8).size();
}

// Although 0.83 of the outline around both is open.
TEST(Joining, IsNotAcrossThePierBetweenTwoWindows) {
  EXPECT_EQ(left_of_two(0.4), 2u);
  // Twins: a mullion, and a bar as thin as the grid resolves.
  EXPECT_EQ(left_of_two(0.2), 1u);
  EXPECT_EQ(left_of_two(0.09), 1u);
}

TEST(Joining, DistanceIsBetweenEdges) {
  const Polygon a{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, b{{1.2, -3}, {2, 5}, {1.2, 5}};
  EXPECT_NEAR(distance_between(a, b), 0.2, 1e-9);
  EXPECT_EQ(distance_between(a, a), 0);
  EXPECT_EQ(distance_between(a, enlarged(a, 0.5)), 0);
}

// A window of 1 m x 1 m across z, and one across y above and behind it, whose light also crosses
// the plane of the first, over its edge at y = 0.5. Returns how high the first one reaches that was
// fitted up to y = 0.8, when `over` of 4000 lines pass the second.
double height_beside(size_t over) {
  LightGrid g;
  g.voxel = kVoxel;
  for (uint64_t i = 0; g.lines.size() < 4000; ++i) {
    Rng rng(17, 1, i);
    const bool second = g.lines.size() < over;
    const double x = rng.uniform() - 0.5, y = rng.uniform();
    const Vec3d slant{0.5 * (rng.uniform() - 0.5), rng.uniform() - 0.5, 1};
    const Vec3d p = second ? Vec3d{x, 0.55 + 0.25 * y, 0} : Vec3d{x, y - 0.5, 0};
    const Vec3d w = normalize(second ? Vec3d{0, 1, 1} : slant);
    g.lines.push_back({p - w, p + w});
  }
  const Bundle all = testing::all_of(g);
  Aperture first = pane(0), above;
  for (Vec2d& corner : first.polygon)
    if (const Vec3d at = to_space(first.tube.middle, corner); at.y > 0)
      corner = in_plane(first.tube.middle, at + Vec3d{0, 0.3, 0});
  above.tube.middle = {{0, 0.9, 0.2}, {0, 1, 0}};
  for (const auto& [x, z] : {std::pair{-0.5, 0.05}, {0.5, 0.05}, {0.5, 0.4}, {-0.5, 0.4}})
    above.polygon.push_back(in_plane(above.tube.middle, {x, 0.9, z}));
  above.polygon = convex_hull(above.polygon);
  std::vector<Aperture> found{first, above};
  for (Aperture& a : found) a.lines = lines_across(all, a);
  part_from_each_other(g, all, found);
  double y = -INFINITY;
  for (const Vec3d& corner : corners_of(found[0])) y = std::max(y, corner.y);
  return y;
}

TEST(Parting, CutsBackWhatFewLinesExtend) {
  EXPECT_NEAR(height_beside(80), 0.5, 0.03);
  EXPECT_NEAR(height_beside(20), 0.8, 1e-6);   // twin: too few to matter
  EXPECT_NEAR(height_beside(800), 0.8, 1e-6);  // and so many that they may be its own
}

}  // namespace tdpt::neighbours_test
