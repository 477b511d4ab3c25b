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

// A box open at the front (z = 0) from y = 0 to 2, the slit, and at the top (y = 2) from z = -0.7
// to 0, the gap; both 0.1 wide. They share the edge y = 2, z = 0. Light leaves the box.
constexpr double kHalf = 0.05, kHigh = 2, kDeep = 0.7;

Aperture rectangle(const Vec3d& middle, const Vec3d& normal, const Vec3d& u, const Vec3d& v) {
  Aperture a;
  a.tube.middle = {middle, normal};
  const Onb<double> frame(normal);
  for (const Vec3d& p : {-u - v, u - v, u + v, v - u})
    a.polygon.push_back({dot(p, frame.x), dot(p, frame.y)});
  const Polygon& q = a.polygon;
  if (cross(q[1] - q[0], q[2] - q[1]) < 0) std::swap(a.polygon[1], a.polygon[3]);
  return a;
}

Aperture slit(double too_high) {
  return rectangle({0, 0.5 * (kHigh + too_high), 0}, {0, 0, 1}, {kHalf, 0, 0},
                   {0, 0.5 * (kHigh + too_high), 0});
}

Aperture gap() {
  return rectangle({0, kHigh, -0.5 * kDeep}, {0, 1, 0}, {kHalf, 0, 0}, {0, 0, 0.5 * kDeep});
}

LightGrid light(size_t n) {
  LightGrid grid;
  grid.voxel = 0.05;
  grid.dim = {100, 100, 100};
  grid.origin = Vec3d{-2.5, -1, -2.5};
  grid.bottleneck = true;
  for (uint64_t i = 0; grid.lines.size() < n; ++i) {
    Rng rng(3, 1, i);
    const bool front = rng.uniform() < 0.85;
    const double a = 2 * rng.uniform() - 1, b = rng.uniform();
    const Vec3d d = cosine_hemisphere(rng.uniform(), rng.uniform());
    const Vec3d place =
        front ? Vec3d{a * kHalf, b * kHigh, 0} : Vec3d{a * kHalf, kHigh, -b * kDeep};
    const Vec3d way = front ? d : Vec3d{d.x, d.z, d.y};
    const Vec3d from = place - way * 0.8, to = place + way * 0.8;
    const bool starts_inside = from.z < 0 && from.y < kHigh;
    if (starts_inside) grid.lines.push_back({from, to});
  }
  return grid;
}

double highest(const Aperture& a) {
  double y = -INFINITY;
  for (const Vec2d& p : a.polygon) y = std::max(y, to_space(a.tube.middle, p).y);
  return y;
}

double through_neither(const std::vector<Aperture>& found, const Bundle& all) {
  size_t neither = 0;
  for (const uint32_t l : all.which)
    neither += std::none_of(found.begin(), found.end(), [&](const Aperture& a) {
      return std::binary_search(a.lines.which.begin(), a.lines.which.end(), l);
    });
  return static_cast<double>(neither) / static_cast<double>(all.size());
}

TEST(Parting, ASharedEdgeBoundsBoth) {
  const auto of_slit = shared_edge(slit(0.3), gap());
  ASSERT_TRUE(of_slit);
  const Aperture a = slit(0.3);
  for (const Vec2d& p : clipped(a.polygon, of_slit->axis, of_slit->limit))
    EXPECT_LT(to_space(a.tube.middle, p).y, kHigh + 1e-9);
  ASSERT_TRUE(shared_edge(gap(), slit(0.3)));
}

TEST(Parting, OpeningsApartShareNothing) {
  Aperture far = gap();
  far.tube.middle.o.x += 1;
  EXPECT_FALSE(shared_edge(slit(0), far));  // beside it
  far.tube.middle.o = gap().tube.middle.o + Vec3d{0, 1, 0};
  EXPECT_FALSE(shared_edge(slit(0), far));  // above it
  Aperture same_wall = slit(0);
  same_wall.tube.middle.o.x += 0.3;
  EXPECT_FALSE(shared_edge(slit(0), same_wall));
  EXPECT_FALSE(shared_edge(slit(0), slit(0)));
}

// The slit has taken the gap's light near their edge: the gap gets it back.
TEST(Parting, EachGetsItsLines) {
  const LightGrid grid = light(6000);
  const Bundle all = testing::all_of(grid);
  Aperture small = gap();
  small.polygon = enlarged(small.polygon, 0.7);
  std::vector<Aperture> found{slit(0.3), small};
  for (Aperture& a : found) a.lines = lines_across(all, a);
  // Twin: the openings before parting fail what is required after it.
  EXPECT_GT(highest(found[0]), kHigh + 0.25);
  EXPECT_LT(area(found[1].polygon), 0.75 * area(gap().polygon));
  EXPECT_GT(through_neither(found, all), 0.02);

  part_at_shared_edges(LightGrid{}, all, found);
  EXPECT_NEAR(highest(found[0]), kHigh, 0.02);
  EXPECT_NEAR(area(found[0].polygon), area(slit(0).polygon), 0.02 * area(slit(0).polygon));
  EXPECT_NEAR(area(found[1].polygon), area(gap().polygon), 0.04 * area(gap().polygon));
  EXPECT_GT(dot(found[0].tube.middle.n, Vec3d{0, 0, 1}), std::cos(0.03));
  EXPECT_GT(dot(found[1].tube.middle.n, Vec3d{0, 1, 0}), std::cos(0.06));
  EXPECT_LT(through_neither(found, all), 0.02);
}

// The gap over a leaf narrows to nothing at the hinge; the thicker the leaf, the fewer lines pass
// there.
TEST(Parting, AThinCornerIsKept) {
  std::vector<Vec2d> places;
  for (uint64_t i = 0; places.size() < 800; ++i) {
    Rng rng(7, 1, i);
    const double x = std::sqrt(rng.uniform()), y = 0.12 * x * rng.uniform();
    if (rng.uniform() < std::pow(x / 0.7, 6)) places.push_back({x, y});
  }
  const auto left_out = [&](const Polygon& outline) {
    return std::count_if(places.begin(), places.end(),
                         [&](Vec2d p) { return p.x < 0.5 && !contains(outline, p); });
  };
  EXPECT_EQ(left_out(outline_of(places, Strays::kept)), 0);
  EXPECT_LT(area(outline_of(places, Strays::kept)), 1.1 * 0.06);
  EXPECT_GT(left_out(outline_of(places)), 0);  // twin: with outliers removed
}

// The slit's own lines are too few for another fit: it stays unchanged.
TEST(Parting, AnOpeningWithoutLinesOfItsOwnStays) {
  const LightGrid grid = light(200);
  const Bundle all = testing::all_of(grid).where([](const LightLine& line) {
    const auto at = crossing(gap().tube.middle, line);
    return at && contains(gap().polygon, *at);
  });
  std::vector<Aperture> found{slit(0), gap()};
  for (Aperture& a : found) a.lines = lines_across(all, a);
  ASSERT_TRUE(found[0].lines.size() < kFewestLines);
  part_at_shared_edges(LightGrid{}, all, found);
  EXPECT_NEAR(area(found[0].polygon), area(slit(0).polygon), 1e-9);
}

}  // namespace tdpt::neighbours_test
