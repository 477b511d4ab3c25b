#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "tools/portalfit/plane.h"

namespace tdpt::plane_test {

Polygon circle(size_t n) {
  Polygon p;
  for (size_t i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    p.push_back({3 + std::cos(a), -2 + std::sin(a)});
  }
  return p;
}

TEST(Polygon, HullOfRandomPointsHoldsThemAll) {
  std::vector<Vec2d> points;
  for (uint64_t i = 0; i < 500; ++i) {
    Rng rng(1, 1, i);
    const double x = rng.uniform(), y = rng.uniform();
    points.push_back({x, y});
  }
  const Polygon hull = convex_hull(points);
  EXPECT_GT(area(hull), 0.9);
  EXPECT_LE(area(hull), 1);
  for (const Vec2d& p : points) EXPECT_TRUE(contains(hull, p));
  EXPECT_LT(convex_hull({{0, 0}, {1, 1}, {2, 2}}).size(), 3u);  // on a line
}

TEST(Polygon, SimplifyingOnlyAdds) {
  const Polygon round = circle(200);
  const Polygon few = simplified(round, 0.01);
  EXPECT_LE(few.size(), 12u);
  EXPECT_GT(area(few), area(round));
  EXPECT_LT(area(few), 1.05 * area(round));
  for (const Vec2d& p : round) EXPECT_TRUE(contains(enlarged(few, 1 + 1e-9), p));
  // A rectangle with slightly cut corners.
  const double e = 0.01;
  const Polygon cut{{e, 0}, {2 - e, 0}, {2, e}, {2, 1 - e}, {2 - e, 1}, {e, 1}, {0, 1 - e}, {0, e}};
  EXPECT_EQ(simplified(cut, 0.003).size(), 4u);
  EXPECT_NEAR(area(simplified(cut, 0.003)), 2, 1e-12);
}

TEST(Polygon, EnlargesAboutItsCentre) {
  const Polygon p = enlarged({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 4);
  EXPECT_NEAR(area(p), 8, 1e-12);
  EXPECT_NEAR(p[0].x, -1, 1e-12);
  EXPECT_NEAR(p[0].y, -0.5, 1e-12);
}

TEST(Polygon, TrianglesCoverThePolygonOnce) {
  const Polygon round = circle(12);
  const auto triangles = triangulate(round);
  EXPECT_EQ(triangles.size(), 10u);
  double sum = 0;
  for (const auto& t : triangles) {
    const double twice = cross(round[t[1]] - round[t[0]], round[t[2]] - round[t[0]]);
    EXPECT_GT(twice, 0);
    sum += 0.5 * twice;
  }
  EXPECT_NEAR(sum, area(round), 1e-12);
}

TEST(Polygon, CutsThroughACornerLeaveNoEdgeWithoutLength) {
  const Polygon square{{-0.3, -0.7}, {0.7, -0.1}, {0.3, 0.9}, {-0.6, 0.4}};
  for (const Vec2d& corner : square)
    for (int k = 0; k < 360; ++k) {
      const Vec2d axis{std::cos(k * 0.0174533), std::sin(k * 0.0174533)};
      const double through = corner.x * axis.x + corner.y * axis.y;
      for (const double limit : {through, through + 1e-16, through - 1e-16}) {
        const Polygon kept = clipped(square, axis, limit);
        if (area(kept) < 0.05) continue;
        Vec2d middle;
        for (const Vec2d& p : kept) middle = middle + p * (1.0 / static_cast<double>(kept.size()));
        EXPECT_TRUE(contains(kept, middle)) << k;
      }
    }
}

}  // namespace tdpt::plane_test
