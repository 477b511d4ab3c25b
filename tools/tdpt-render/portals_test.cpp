#include "tools/tdpt-render/portals.h"

#include <numbers>

#include <gtest/gtest.h>

namespace tdpt {
namespace {

// Unit square in the plane z = 0 with normal +z, and a second one, twice as large, in x = 5.
Portal square() {
  return {"a", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}};
}
Portal far_square() {
  return {"b", {{5, 0, 0}, {5, 2, 0}, {5, 2, 1}, {5, 0, 1}}, {{0, 1, 2}, {0, 2, 3}}, {}};
}
const Frame kMetres{};

TEST(portals, density_is_p_q_over_area_and_pi) {
  const PortalSet one({square()}, kMetres);
  EXPECT_DOUBLE_EQ(one.density({0.3, 0.2, -1}, {0.3, 0.2, 1}), 1 / std::numbers::pi);
  EXPECT_DOUBLE_EQ(one.density({0.2, 0.7, -1}, {0.2, 0.8, 9}), 1 / std::numbers::pi);
  const PortalSet two({square(), far_square()}, kMetres);  // total area 3
  EXPECT_DOUBLE_EQ(two.density({0.3, 0.2, -1}, {0.3, 0.2, 1}), 1 / (3 * std::numbers::pi));
}

TEST(portals, a_segment_that_crosses_two_portals_has_both_densities) {
  Portal above = square();
  for (Vec3d& v : above.vertices) v.z += 0.5;
  for (Vec3d& v : above.vertices) v.y += 0.9;  // no pair
  above.vertices[1].z = above.vertices[2].z = -0.1;
  const PortalSet set({square(), above}, kMetres);
  ASSERT_EQ(set.pairs(), 0u);
  EXPECT_NEAR(set.density({0.3, 0.95, -1}, {0.3, 0.95, 1}), 2 * set.polygon(0).density, 1e-12);
  EXPECT_NEAR(set.density({0.3, 0.95, -1}, {0.3, 0.95, 0.2}), set.polygon(0).density, 1e-12);
}

TEST(portals, one_behind_the_other_has_segments_drawn_through_both) {
  Portal above = square();
  for (Vec3d& v : above.vertices) v.z += 0.5;
  const PortalSet set({square(), above}, kMetres);
  EXPECT_EQ(set.pairs(), 1u);
  // Three quarters of two portals, and a quarter of a pair half a metre apart.
  EXPECT_DOUBLE_EQ(set.density({0.3, 0.2, -1}, {0.3, 0.2, 1}),
                   0.75 / std::numbers::pi + 0.25 * 0.5 * 0.5);
  EXPECT_DOUBLE_EQ(set.density({0.3, 0.2, -1}, {0.3, 0.2, 0.2}), 0.75 / (2 * std::numbers::pi));
  // At an angle of 45 degrees: d^2 = 0.5, cosines 1 / sqrt 2.
  EXPECT_NEAR(set.density({-0.7, 0.2, -1}, {1.3, 0.2, 1}),
              0.75 / std::numbers::pi + 0.25 * 0.5 / 0.5, 1e-12);
  // What was drawn through both and is stopped between them is not spanned.
  EXPECT_TRUE(set.spans({0, 2}, {0.3, 0.2, -1}, {0.3, 0.2, 1}));
  EXPECT_FALSE(set.spans({0, 2}, {0.3, 0.2, -1}, {0.3, 0.2, 0.2}));
  EXPECT_FALSE(set.spans({0, 2}, {0.3, 0.2, 0.1}, {0.3, 0.2, 1}));
  EXPECT_TRUE(set.spans({0, -1}, {0.3, 0.2, -1}, {0.3, 0.2, 0.2}));
}

TEST(portals, beside_or_across_each_other_are_no_pair) {
  Portal beside = square(), across = square();
  for (Vec3d& v : beside.vertices) v.x += 2;
  for (Vec3d& v : across.vertices) v = {v.x, v.z + 0.5, v.y - 0.5};
  EXPECT_EQ(PortalSet({square(), beside}, kMetres).pairs(), 0u);
  EXPECT_EQ(PortalSet({square(), across}, kMetres).pairs(), 0u);
}

TEST(portals, no_density_against_the_normal_beside_the_portal_or_short_of_it) {
  const PortalSet set({square()}, kMetres);
  EXPECT_EQ(set.density({0.3, 0.2, 1}, {0.3, 0.2, -1}), 0);
  EXPECT_EQ(set.density({1.3, 0.2, -1}, {1.3, 0.2, 1}), 0);
  EXPECT_EQ(set.density({0.3, 0.2, -1}, {0.3, 0.2, -0.1}), 0);
  EXPECT_EQ(set.density({0.3, 0.2, 0.1}, {0.3, 0.2, 1}), 0);
}

TEST(portals, the_sampled_polygon_is_always_counted) {
  const PortalSet set({square()}, kMetres);
  EXPECT_GT(set.density({1.0000001, 0.2, -1}, {1.0000001, 0.2, 1}, {0, -1}), 0);
}

TEST(portals, a_segment_that_ends_in_the_portals_plane_has_no_density) {
  const PortalSet set({square()}, kMetres);
  EXPECT_EQ(set.density({0.3, 0.2, -1}, {0.3, 0.2, 1e-7}, {0, -1}), 0);
  EXPECT_EQ(set.density({0.3, 0.2, -1e-7}, {0.3, 0.2, 1}, {0, -1}), 0);
  EXPECT_GT(set.density({0.3, 0.2, -1e-5}, {0.3, 0.2, 1}, {0, -1}), 0);
}

TEST(portals, degenerate_triangles_are_dropped_and_no_portal_is_empty) {
  const Portal line{"l", {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}, {}};
  EXPECT_TRUE(PortalSet({line}, kMetres).empty());
  EXPECT_TRUE(PortalSet({}, kMetres).empty());
}

// Samples of two squares binned by square (1:2 by area), quarter of the square and cos^2 (cos^2 is
// uniform for a cosine distribution); chi-square against probabilities skewed by `fault`.
bool samples_hold(double fault) {
  const PortalSet set({square(), far_square()}, kMetres);
  std::array<double, 2 * 4 * 4> hits{}, expected{};
  Rng rng(9, 0, 0);
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    const PortalSet::Sample s = set.sample(rng);
    const bool far = s.drawn.polygon >= 2;
    const double u = far ? s.position.y / 2 : s.position.x;
    const double v = far ? s.position.z : s.position.y;
    const double c = dot(s.direction, set.polygon(s.drawn.polygon).normal);
    EXPECT_GE(c, 0);
    const auto bin = [](double x, int bins) {
      return std::clamp(static_cast<int>(x * bins), 0, bins - 1);
    };
    const int b = ((far ? 4 : 0) + 2 * bin(u, 2) + bin(v, 2)) * 4 + bin(c * c, 4);
    hits[static_cast<size_t>(b)] += 1;
  }
  double chi2 = 0;
  for (size_t b = 0; b < hits.size(); ++b) {
    expected[b] = n * (b < 16 ? 1.0 / 3 : 2.0 / 3) / 16 * (b == 20 ? fault : 1);
    chi2 += (hits[b] - expected[b]) * (hits[b] - expected[b]) / expected[b];
  }
  return chi2 < 61.1;  // 31 degrees of freedom: p about 1e-3
}
TEST(portals, samples_follow_the_density) {
  EXPECT_TRUE(samples_hold(1));
}
TEST(portals, twin_a_density_off_by_10_percent_in_one_bin_is_caught) {
  EXPECT_FALSE(samples_hold(1.1));
}

}  // namespace
}  // namespace tdpt
