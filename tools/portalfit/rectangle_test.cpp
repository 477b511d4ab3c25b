#include "tools/portalfit/renderers.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "tools/portalfit/plane.h"

namespace tdpt::rectangle_test {

// The convex polygon in the plane of u and v around `at`.
Portal portal(const Polygon& polygon, const Vec3d& at, const Vec3d& u, const Vec3d& v) {
  Portal p;
  for (const Vec2d& q : polygon) p.vertices.push_back(at + u * q.x + v * q.y);
  for (uint32_t i = 2; i < p.vertices.size(); ++i) p.triangles.push_back({0, i - 1, i});
  return p;
}

Polygon box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

void expect_near(const Vec3d& a, const Vec3d& b) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-12);
}

// Checks that the frame is orthonormal, and that the rectangle contains every corner and is touched
// on its four sides.
void expect_tight(const Portal& p, const Rectangle& r) {
  EXPECT_NEAR(length(r.x), 1, 1e-12);
  EXPECT_NEAR(length(r.y), 1, 1e-12);
  expect_near(cross(r.x, r.y), r.normal);
  double low_x = 0, high_x = 0, low_y = 0, high_y = 0;
  for (const Vec3d& v : p.vertices) {
    const Vec3d d = v - r.centre;
    EXPECT_NEAR(dot(d, r.normal), 0, 1e-12);
    low_x = std::min(low_x, dot(d, r.x)), high_x = std::max(high_x, dot(d, r.x));
    low_y = std::min(low_y, dot(d, r.y)), high_y = std::max(high_y, dot(d, r.y));
  }
  EXPECT_NEAR(low_x, -0.5 * r.width, 1e-12);
  EXPECT_NEAR(high_x, 0.5 * r.width, 1e-12);
  EXPECT_NEAR(low_y, -0.5 * r.height, 1e-12);
  EXPECT_NEAR(high_y, 0.5 * r.height, 1e-12);
}

TEST(Rectangle, AWindowKeepsItsWidthHeightAndNormal) {
  // In a wall at x = 2; light goes to -x, or to +x where the triangles turn the other way.
  for (const double way : {1.0, -1.0}) {
    const Portal p = portal(box(-1, 0, 1, 1.5), {2, 1, 3}, {0, 0, way}, {0, 1, 0});
    const Rectangle r = rectangle_of(p);
    expect_tight(p, r);
    expect_near(r.centre, {2, 1.75, 3});
    expect_near(r.normal, {-way, 0, 0});
    expect_near(r.y, {0, 1, 0});
    expect_near(r.x, {0, 0, way});
    EXPECT_NEAR(r.width, 2, 1e-12);
    EXPECT_NEAR(r.height, 1.5, 1e-12);
    const std::vector<Vec3d> c = r.corners();
    ASSERT_EQ(c.size(), 4u);
    expect_near(cross(c[1] - c[0], c[3] - c[0]), r.normal * (r.width * r.height));
    expect_near(c[2] - c[1], c[3] - c[0]);
  }
}

TEST(Rectangle, TheUprightSideIsTheHeight) {
  for (int i = 0; i < 24; ++i) {
    const double a = 2 * std::numbers::pi * i / 24;
    const Vec3d u{std::cos(a), std::sin(a), 0}, v{-std::sin(a), std::cos(a), 0};
    const Portal p = portal(box(-1, -0.25, 1, 0.25), {1, 1, 1}, u, v);
    const Rectangle r = rectangle_of(p);
    expect_tight(p, r);
    EXPECT_NEAR(r.width * r.height, 1, 1e-12);
    EXPECT_GE(r.y.y, std::sqrt(0.5) - 1e-12);
  }
  for (const Polygon& skylight : {box(0, 0, 3, 1), box(0, 0, 1, 3)}) {  // wider than high
    const Rectangle r = rectangle_of(portal(skylight, {0, 2.5, 0}, {1, 0, 0}, {0, 0, 1}));
    expect_near(r.normal, {0, -1, 0});
    EXPECT_NEAR(r.width, 3, 1e-12);
  }
}

TEST(Rectangle, NoOtherAroundAPolygonIsSmaller) {
  for (uint64_t i = 0; i < 20; ++i) {
    std::vector<Vec2d> points;
    for (uint64_t k = 0; k < 9; ++k) {
      Rng rng(7, i, k);
      const double x = rng.uniform(), y = rng.uniform();
      points.push_back({x, 0.6 * y});
    }
    const Polygon hull = convex_hull(points);
    const Portal p = portal(hull, {5, -3, 2}, {0.6, 0, 0.8}, {0, 1, 0});
    const Rectangle r = rectangle_of(p);
    expect_tight(p, r);
    for (int turn = 0; turn < 360; ++turn) {
      const double a = 0.5 * std::numbers::pi * turn / 360, c = std::cos(a), s = std::sin(a);
      double low_u = 1e9, high_u = -1e9, low_v = 1e9, high_v = -1e9;
      for (const Vec2d& q : hull) {
        const double u = c * q.x + s * q.y, v = c * q.y - s * q.x;
        low_u = std::min(low_u, u), high_u = std::max(high_u, u);
        low_v = std::min(low_v, v), high_v = std::max(high_v, v);
      }
      EXPECT_LE(r.width * r.height, (high_u - low_u) * (high_v - low_v) + 1e-9);
    }
  }
}

Rectangle window(double x0, double y0, double x1, double y1, double z = 0) {
  return rectangle_of(portal(box(x0, y0, x1, y1), {0, 0, z}, {1, 0, 0}, {0, 1, 0}));
}

TEST(Overlaps, WindowsThatShareAPlaceAreOne) {
  const auto joined =
      without_overlaps({window(0, 0, 1, 1), window(5, 0, 6, 1), window(0.9, 0, 2, 2, 0.05)});
  ASSERT_EQ(joined.size(), 2u);
  expect_near(joined[0].normal, {0, 0, 1});
  EXPECT_NEAR(joined[0].width, 2, 1e-12);
  EXPECT_NEAR(joined[0].height, 2, 1e-12);
  // The rectangle around the first and the last contains the second, which touched neither.
  const auto third =
      without_overlaps({window(0, 0, 3, 1), window(2, 2, 3, 3), window(0, 0.5, 1, 4)});
  EXPECT_EQ(third.size(), 1u);
}

TEST(Overlaps, NeighboursAndOtherWallsStay) {
  const std::vector<Rectangle> apart{
      window(0, 0, 1, 1), window(1, 0, 2, 1),                                       // an edge
      window(0, 0, 1, 1, 3),                                                        // behind
      rectangle_of(portal(box(0, 0, 1, 1), {0, 0, 0}, {0, 0, 1}, {0, 1, 0})),       // a corner
      rectangle_of(portal(box(0, 0, 1, 1), {1, 0, 0.01}, {-1, 0, 0}, {0, 1, 0}))};  // turned
  EXPECT_EQ(without_overlaps(apart).size(), apart.size());
}

}  // namespace tdpt::rectangle_test
