// The headers of this folder that need no scene, compiled as C++.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/math/vec.h"
#include "libcommon/testing/statistics/chi_square.h"
#include "shaders/shared/grid_walk.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/warp.h"

namespace tdpt::shader::shared_test {

using tdpt::Rng;

// Published first outputs of SplitMix64 from the state 1234567.
TEST(random_bits, gives_the_published_numbers) {
  shader::Rng rng;
  rng.key = 1234567;
  for (const uint64_t wanted :
       {6457827717110365317ull, 3203168211198807973ull, 9817491932198370423ull,
        4593380528125082431ull, 16408922859458223821ull})
    EXPECT_EQ(random_bits(rng), wanted);
}

TEST(unit_float, stays_below_1) {
  EXPECT_EQ(unit_float(0), 0.0f);
  EXPECT_LT(unit_float(~0u), 1.0f);
  EXPECT_EQ(below(~0u, 7), 6u);
  EXPECT_EQ(below(0, 7), 0u);
}

// Largest relative error of f against the exact one, in units in the last place, over `n` floats of
// every size from 1e-`digits` to 1e`digits`.
template <class F, class Exact>
double worst(double digits, F f, Exact exact) {
  double most = 0;
  Rng rng(1, 0, 0);
  for (int i = 0; i < 1 << 18; ++i) {
    const auto x = static_cast<float>(std::pow(10, digits * (2 * rng.uniform() - 1)));
    const double e = exact(double{x});
    most = std::max(most, std::abs(f(x) - e) / std::abs(e) * 0x1p24);
  }
  return most;
}

TEST(real, keeps_to_its_bounds) {
  const double inverse = worst(
      36, [](float x) { return reciprocal(x); }, [](double x) { return 1 / x; });
  const double inverse_roots = worst(
      36, [](float x) { return inverse_root(x); }, [](double x) { return 1 / std::sqrt(x); });
  const double roots = worst(
      36, [](float x) { return root(x); }, [](double x) { return std::sqrt(x); });
  RecordProperty("reciprocal_ulp", std::to_string(inverse));
  EXPECT_LT(inverse, 2 * 2);
  EXPECT_LT(inverse_roots, 3 * 2);
  EXPECT_LT(roots, 3 * 2);
  // Twin: one iteration less is not enough.
  const auto short_of = [](float x) {
    float y = uintBitsToFloat(0x7EF311C7u - floatBitsToUint(x));
    y = y * (2.0f - x * y);
    return y * (2.0f - x * y);
  };
  EXPECT_GT(worst(36, short_of, [](double x) { return 1 / x; }), 100);
  EXPECT_FLOAT_EQ(reciprocal(-4.0f), -0.25f);
  EXPECT_EQ(root(0.0f), 0.0f);
  EXPECT_EQ(root(1e-40f), 0.0f);
  EXPECT_FLOAT_EQ(root(1.0f), 1.0f);
}

TEST(real, sines_are_good_to_2e_7) {
  double most = 0;
  for (uint i = 0; i < 1u << 18; ++i) {
    const float turns = unit_float(i << 14);
    float c, s;
    cos_sin_turns(turns, c, s);
    const double angle = 2 * std::numbers::pi * turns;
    most = std::max({most, std::abs(c - std::cos(angle)), std::abs(s - std::sin(angle))});
  }
  EXPECT_LT(most, 2e-7);
  RecordProperty("error", std::to_string(most * 1e7) + "e-7");
}

// p value of `draw(u, v)`, directions about (2,-1,-3)/sqrt(14), against cos/pi.
template <class Draw>
double p_of_cosine(Draw draw) {
  const Vec3d n = normalize(Vec3d(2, -1, -3));
  const SphereBins bins(16, 12);
  const std::vector<double> probability =
      bins.integrate([&](const Vec3d& w) { return std::max(0.0, dot(w, n)) / std::numbers::pi; });
  return chi_square_of_samples(100000, probability,
                               [&](uint64_t i) {
                                 Rng r(7, 1, i);
                                 const float u = r.uniform_float();
                                 const float v = r.uniform_float();
                                 return bins.bin(normalize(Vec3d(draw(Vec3f(n), u, v))));
                               })
      .p;
}

TEST(cosine_hemisphere, follows_its_density) {
  EXPECT_GT(p_of_cosine([](vec3 n, float u, float v) { return cosine_hemisphere(n, u, v); }), 1e-4);
  // Twin: uniform instead of cosine.
  EXPECT_LT(p_of_cosine([](vec3 n, float u, float v) {
              return cosine_hemisphere(n, u, 1 - (1 - v) * (1 - v));
            }),
            1e-9);
}

TEST(cosine_hemisphere, is_unit_and_in_front_for_every_normal) {
  Rng rng(3, 0, 0);
  for (int i = 0; i < 100000; ++i) {
    const double x = rng.uniform() - 0.5, y = rng.uniform() - 0.5, z = rng.uniform() - 0.5;
    const vec3 n = i < 6 ? vec3(i / 2 == 0, i / 2 == 1, i / 2 == 2) * (i % 2 ? 1.0f : -1.0f)
                         : vec3(normalize(Vec3d(x, y, z)));
    const float u = rng.uniform_float();
    const float v = rng.uniform_float();
    const vec3 w = cosine_hemisphere(n, u, v);
    ASSERT_NEAR(length(Vec3d(w)), 1, 1e-6);
    ASSERT_NEAR(dot(Vec3d(w), Vec3d(n)), std::sqrt(1 - v), 1e-6);
  }
}

TEST(uniform_triangle, is_uniform_by_area) {
  // Nine parts of equal area: each third of the sides.
  const vec3 a(0, 0, 0), b(3, 0, 0), c(0, 3, 0);
  const auto p = [&](double exponent) {
    return chi_square_of_samples(
               90000, std::vector<double>(9, 1 / 9.0),
               [&](uint64_t i) {
                 Rng r(7, 2, i);
                 const auto u = static_cast<float>(std::pow(r.uniform(), exponent));
                 const float v = r.uniform_float();
                 float b1, b2;
                 uniform_triangle(u, v, b1, b2);
                 EXPECT_LE(b1 + b2, 1.000001f);
                 const vec3 q = a + (b - a) * b1 + (c - a) * b2;
                 const auto x = static_cast<size_t>(q.x), y = static_cast<size_t>(q.y);
                 const bool upper = q.x - std::floor(q.x) + q.y - std::floor(q.y) > 1;
                 // Row y holds 5, 3 or 1 of them.
                 const size_t first[] = {0, 5, 8};
                 return std::min<size_t>(first[std::min<size_t>(y, 2)] + 2 * x + upper, 8);
               })
        .p;
  };
  EXPECT_GT(p(1), 1e-4);
  EXPECT_LT(p(1.2), 1e-9);  // twin
}

std::vector<ivec3> walked(vec3 a, vec3 b, ivec3 dim) {
  std::vector<ivec3> out;
  auto w = voxel_walk(a, b, dim);
  do {
    out.push_back(w.at);
  } while (next_voxel(w) && out.size() < 100000);
  return out;
}

TEST(voxel_walk, visits_the_voxels_counted_by_hand) {
  using Voxels = std::vector<ivec3>;
  const ivec3 dim(8, 8, 8);
  // Along an axis, both ways; between voxels' walls.
  EXPECT_EQ(walked({0.5f, 1.5f, 2.5f}, {3.5f, 1.5f, 2.5f}, dim),
            (Voxels{{0, 1, 2}, {1, 1, 2}, {2, 1, 2}, {3, 1, 2}}));
  EXPECT_EQ(walked({3.5f, 1.5f, 2.5f}, {1.5f, 1.5f, 2.5f}, dim),
            (Voxels{{3, 1, 2}, {2, 1, 2}, {1, 1, 2}}));
  // On the wall between two voxels the upper one counts.
  EXPECT_EQ(walked({0.5f, 2, 2.5f}, {2.5f, 2, 2.5f}, dim),
            (Voxels{{0, 2, 2}, {1, 2, 2}, {2, 2, 2}}));
  // Slanted: x = 1 at t = 1/4, y = 1 at 1/2, x = 2 at 3/4.
  EXPECT_EQ(walked({0.5f, 0.5f, 0.5f}, {2.5f, 1.5f, 0.5f}, dim),
            (Voxels{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {2, 1, 0}}));
  // Through corners: x first, then y, then z.
  EXPECT_EQ(walked({0, 0, 0}, {2, 2, 2}, dim),
            (Voxels{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {2, 1, 1}, {2, 2, 1}, {2, 2, 2}}));
  EXPECT_EQ(walked({2, 2, 2}, {0, 0, 0}, dim).back(), ivec3(0, 0, 0));
  // Zero length, also on a corner.
  EXPECT_EQ(walked({3.5f, 3.5f, 3.5f}, {3.5f, 3.5f, 3.5f}, dim), (Voxels{{3, 3, 3}}));
  EXPECT_EQ(walked({3, 3, 3}, {3, 3, 3}, dim), (Voxels{{3, 3, 3}}));
  // Parts outside are clamped to the border; so is the far wall.
  EXPECT_EQ(walked({-1, 0.5f, 0.5f}, {1.5f, 0.5f, 0.5f}, dim), (Voxels{{0, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(walked({7.5f, 8, 8}, {8, 8, 8}, dim), (Voxels{{7, 7, 7}}));
}

// Length of the segment a-b within a voxel, in doubles.
double length_within(const ivec3& voxel, const Vec3d& a, const Vec3d& b) {
  double enter = 0, leave = 1;
  for (int c = 0; c < 3; ++c) {
    const double d = b[c] - a[c];
    if (d == 0) {
      if (a[c] < voxel[c] || a[c] > voxel[c] + 1) return 0;
      continue;
    }
    const double t0 = (voxel[c] - a[c]) / d, t1 = (voxel[c] + 1 - a[c]) / d;
    enter = std::max(enter, std::min(t0, t1));
    leave = std::min(leave, std::max(t0, t1));
  }
  return std::max(0.0, leave - enter) * length(b - a);
}

// Checks that the voxels are neighbours in order from end to end, and, by `length_within`, that
// exactly the voxels are visited that the segment passes, except at corners that rounding passes on
// the other side. `shift` moves the walked segment; `corner`: shorter passages [voxels] do not
// count. Returns the share of segments and voxels that fail.
template <class Real>
double share_that_differs(Real shift, double corner) {
  uint64_t different = 0, all = 0;
  for (uint64_t i = 0; i < 20000; ++i) {
    Rng rng(4, 0, i);
    float x[6];
    for (float& v : x) v = rng.uniform_float();
    if (i % 7 == 0) x[3] = x[0];                           // across an axis
    if (i % 11 == 0) x[3] = x[0], x[4] = x[1];             // along one
    if (i % 13 == 0) x[3] = x[0] + 1e-6f * (x[3] - x[0]);  // nearly across
    const Vec3f a(x[0] * 97, x[1] * 64, x[2] * 128), b(x[3] * 97, x[4] * 64, x[5] * 128);
    const Vec3<Real> s(shift, 0, 0);
    double inside = 0;
    ivec3 last;
    Real t = 0;
    bool first = true;
    auto w = voxel_walk(Vec3<Real>(a) + s, Vec3<Real>(b) + s, {97, 64, 128});
    do {
      if (!first) {
        const ivec3 d = w.at - last;
        EXPECT_EQ(std::abs(d.x) + std::abs(d.y) + std::abs(d.z), 1);
      }
      const Real to = std::max(t, leaves_voxel(w));
      const double whole = length(Vec3d(b - a)), within = length_within(w.at, Vec3d(a), Vec3d(b));
      ++all;
      different += (within < corner && whole > 1e-3) || std::abs(within - (to - t) * whole) > 1e-3;
      inside += within;
      last = w.at;
      t = to;
      first = false;
    } while (next_voxel(w));
    EXPECT_EQ(t, Real(1));
    ++all;
    different += std::abs(inside - length(Vec3d(b) - Vec3d(a))) > 1e-3;
  }
  return static_cast<double>(different) / static_cast<double>(all);
}

TEST(voxel_walk, passes_what_it_visits_and_nothing_else_but_for_rounding) {
  EXPECT_LT(share_that_differs<float>(0, 1e-4), 1e-3);
  EXPECT_LT(share_that_differs<double>(0, 1e-12), 1e-6);
  EXPECT_GT(share_that_differs<float>(0.05f, 1e-4), 1e-2);  // twins
  EXPECT_GT(share_that_differs<double>(0.05, 1e-12), 1e-2);
}

}  // namespace tdpt::shader::shared_test
