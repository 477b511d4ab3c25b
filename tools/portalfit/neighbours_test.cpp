#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "tools/portalfit/opening.h"
#include "tools/portalfit/testing/bundle.h"

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
  LightGrid g;
  std::vector<Aperture> panes{pane(0), pane(1 + gap)};
  for (uint64_t i = 0; i < 4000; ++i) {
    Rng rng(13, 1, i);
    const double x = rng.uniform() - 0.5 + (i % 2 == 0 ? 0 : 1 + gap), y = rng.uniform() - 0.5;
    const double u = rng.uniform(), v = rng.uniform();
    const Vec3d w = cosine_hemisphere(u, v), p{x, y, 0};
    g.lines.push_back({p - w * 2, p + w * 2});
  }
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

}  // namespace tdpt::neighbours_test
