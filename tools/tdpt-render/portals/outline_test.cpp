// Polygons drawn with many triangles are covered exactly by few.
#include "tools/tdpt-render/portals/outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "libcommon/math/rng.h"

namespace tdpt::outline_test {

// In a plane that is not axis-aligned.
const Vec3d kRight = normalize(Vec3d(1, 0.2, -0.3)),
            kNormal = normalize(cross(kRight, Vec3d(0, 1, 0.1))), kUp = cross(kNormal, kRight);
Vec3d place(double x, double y) {
  return Vec3d(3, 1, -2) + kRight * x + kUp * y;
}

using Covered = std::function<bool(int, int)>;
/// Cells of a grid, two triangles each.
PlanarFacet cells(int n, const Covered& covered) {
  PlanarFacet f{kNormal, {}};
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      if (!covered(x, y)) continue;
      const Vec3d a = place(x, y), b = place(x + 1, y), c = place(x + 1, y + 1),
                  d = place(x, y + 1);
      f.triangles.push_back({a, b, c});
      f.triangles.push_back({a, c, d});
    }
  return f;
}

bool holds(const Corners& t, const Vec3d& p) {
  for (size_t i = 0; i < 3; ++i)
    if (dot(cross(t[(i + 1) % 3] - t[i], p - t[i]), kNormal) < 0) return false;
  return true;
}
size_t times_covered(const std::vector<Corners>& triangles, const Vec3d& p) {
  size_t n = 0;
  for (const Corners& t : triangles) n += holds(t, p);
  return n;
}
/// Whether random points are covered by the same number of triangles.
bool cover_the_same(const std::vector<Corners>& a, const std::vector<Corners>& b, double size) {
  for (uint64_t i = 0; i < 4000; ++i) {
    Rng rng(1, 1, i);
    const double x = rng.uniform(), y = rng.uniform();
    const Vec3d p = place(size * (1.2 * x - 0.1), size * (1.2 * y - 0.1));
    if (times_covered(a, p) != times_covered(b, p)) return false;
  }
  return true;
}

std::vector<Corners> fewest(const PlanarFacet& facet) {
  return fewest_triangles(facet, 1e-9);
}

TEST(Outline, a_rectangle_of_many_triangles_takes_two) {
  const PlanarFacet grid = cells(10, [](int, int) { return true; });
  ASSERT_EQ(grid.triangles.size(), 200u);
  EXPECT_EQ(fewest(grid).size(), 2u);
  EXPECT_TRUE(cover_the_same(fewest(grid), grid.triangles, 10));
  // Twins: a triangle missing, and one doubled.
  std::vector<Corners> less = grid.triangles;
  less.pop_back();
  EXPECT_FALSE(cover_the_same(fewest(grid), less, 10));
  less.push_back(less.front());
  EXPECT_FALSE(cover_the_same(fewest(grid), less, 10));
}

TEST(Outline, dents_and_holes_stay) {
  const PlanarFacet l = cells(6, [](int x, int y) { return x < 2 || y < 2; });
  EXPECT_EQ(fewest(l).size(), 4u);
  EXPECT_TRUE(cover_the_same(fewest(l), l.triangles, 6));
  const PlanarFacet frame =
      cells(6, [](int x, int y) { return x == 0 || y == 0 || x == 5 || y == 5; });
  EXPECT_EQ(fewest(frame).size(), 8u);
  EXPECT_TRUE(cover_the_same(fewest(frame), frame.triangles, 6));
  // Glazing bars: four panes apart, and the bars themselves.
  const Covered bars = [](int x, int y) { return x % 5 == 0 || y % 5 == 0; };
  const PlanarFacet panes = cells(11, [&](int x, int y) { return !bars(x, y); });
  EXPECT_EQ(fewest(panes).size(), 8u);
  EXPECT_TRUE(cover_the_same(fewest(panes), panes.triangles, 11));
  const PlanarFacet cross = cells(11, bars);
  EXPECT_EQ(fewest(cross).size(), 26u);  // 20 corners, 4 holes: n + 2 h - 2
  EXPECT_TRUE(cover_the_same(fewest(cross), cross.triangles, 11));
}

TEST(Outline, whatever_is_drawn_is_covered_as_before) {
  size_t before = 0, after = 0;
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    Rng rng(seed, 2, 0);
    std::vector<bool> drawn(64);
    for (size_t i = 0; i < drawn.size(); ++i)
      drawn[i] = rng.uniform() < 0.4 + 0.01 * static_cast<double>(seed);
    const PlanarFacet f =
        cells(8, [&](int x, int y) { return drawn[static_cast<size_t>(8 * y + x)]; });
    const auto few = fewest(f);
    EXPECT_LE(few.size(), f.triangles.size());
    EXPECT_TRUE(cover_the_same(few, f.triangles, 8)) << seed;
    before += f.triangles.size();
    after += few.size();
  }
  EXPECT_LT(after, before);
}

TEST(Outline, what_cannot_be_fewer_keeps_its_triangles) {
  PlanarFacet disc{kNormal, {}};
  const auto rim = [](int i) {
    return place(std::cos(2 * std::numbers::pi * i / 48), std::sin(2 * std::numbers::pi * i / 48));
  };
  for (int i = 1; i + 1 < 48; ++i) disc.triangles.push_back({rim(0), rim(i), rim(i + 1)});
  EXPECT_EQ(fewest(disc), disc.triangles);
  // A fan about its centre has two more.
  PlanarFacet fan{kNormal, {}};
  for (int i = 0; i < 48; ++i) fan.triangles.push_back({place(0, 0), rim(i), rim((i + 1) % 48)});
  EXPECT_EQ(fewest(fan).size(), 46u);
}

// The density counts a point as often as triangles cover it.
TEST(Outline, what_overlaps_is_left_as_it_is) {
  PlanarFacet twice = cells(3, [](int, int) { return true; });
  const PlanarFacet again = cells(3, [](int, int) { return true; });
  twice.triangles.insert(twice.triangles.end(), again.triangles.begin(), again.triangles.end());
  EXPECT_EQ(fewest(twice).size(), twice.triangles.size());
  // Wound around a corner, overlapping itself.
  PlanarFacet wound{kNormal, {}};
  const auto at = [](int i, double r) {
    return place(r * std::cos(0.5 * i), r * std::sin(0.5 * i));
  };
  for (int i = 0; i < 16; ++i) {
    wound.triangles.push_back({at(i, 1), at(i, 2), at(i + 1, 2)});
    wound.triangles.push_back({at(i, 1), at(i + 1, 2), at(i + 1, 1)});
  }
  EXPECT_EQ(fewest(wound), wound.triangles);
}

}  // namespace tdpt::outline_test
