#include "tools/portalfit/joining.h"

#include <gtest/gtest.h>

namespace tdpt {
namespace {

// 1 m x 1 m in the plane across z, its middle at (x, 0, z), turned about the y axis.
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

LightGrid grid() {
  LightGrid g;
  g.voxel = 0.05;
  return g;
}

TEST(Joining, PanesInOnePlaneLeaveTheirShareOpen) {
  const Joint joint = joint_of(grid(), {pane(0), pane(1.25)});
  EXPECT_TRUE(joint.flat);
  EXPECT_NEAR(area(joint.outline), 2.25, 1e-9);
  EXPECT_NEAR(joint.open, 2 / 2.25, 1e-9);
}

TEST(Joining, PanesOfABayAreNotFlat) {
  EXPECT_FALSE(joint_of(grid(), {pane(0, 0, -0.6), pane(1, 0, 0.6)}).flat);
  EXPECT_FALSE(joint_of(grid(), {pane(0), pane(1.25, 0.6)}).flat);  // one behind the other
  EXPECT_FALSE(joint_of(grid(), {pane(0), pane(1, 0.5, 1)}).flat);
}

TEST(Joining, DistanceIsBetweenEdges) {
  const Polygon a{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, b{{1.2, -3}, {2, 5}, {1.2, 5}};
  EXPECT_NEAR(distance_between(a, b), 0.2, 1e-9);
  EXPECT_EQ(distance_between(a, a), 0);
  EXPECT_EQ(distance_between(a, enlarged(a, 0.5)), 0);
}

}  // namespace
}  // namespace tdpt
