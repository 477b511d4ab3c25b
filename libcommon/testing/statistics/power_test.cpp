#include "libcommon/testing/statistics/power.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libcommon/math/rng.h"
#include "libcommon/testing/statistics/z_test.h"

namespace tdpt::testing::power_test {

TEST(power, of_many_degrees_of_freedom_is_that_of_the_normal_distribution) {
  // 4.417 leaves 1e-5 outside on both sides, 3.090 leaves 1e-3 on one side.
  EXPECT_NEAR(least_shift(1e6), 4.417 + 3.090, 1e-3);
  EXPECT_NEAR(samples_by_drift(100, 2 * (4.417 + 3.090), 1e6), 25, 0.01);
  EXPECT_GT(least_shift(15), 1.3 * least_shift(1e6));
  EXPECT_GT(least_shift(30, {1e-7, 0.999}), least_shift(30));
  // One block is a z without its sign.
  EXPECT_NEAR(std::sqrt(least_noncentrality(1)), least_shift(1e6), 1e-3);
  EXPECT_NEAR(samples_by_rms(8, std::sqrt(1 + least_noncentrality(48) / 48), 48), 8, 1e-6);
}

/// 16 runs of 48 blocks, each value the mean of `samples` numbers with a deviation of 10 %.
BlockRuns runs_of(uint64_t seed, double samples, double bias, double in_places) {
  BlockRuns out;
  for (uint64_t r = 0; r < 16; ++r) {
    Rng rng(seed, 0, r);
    std::vector<double> values;
    for (int b = 0; b < 48; ++b) {
      const double u = 1 - rng.uniform(), v = rng.uniform();
      const double noise = std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
      values.push_back((1 + bias + (b % 2 ? in_places : -in_places)) *
                       (1 + 0.1 * noise / std::sqrt(samples)));
    }
    out.add(values);
  }
  return out;
}

/// Share of 1000 tests with so many samples that detect a fault by `p`.
double seen(double samples, double bias, double in_places, double Agreement::*p, double least) {
  double n = 0;
  for (uint64_t seed = 1; seed <= 1000; ++seed) {
    const Agreement a =
        compare(runs_of(2 * seed, samples, bias, in_places), runs_of(2 * seed + 1, samples, 0, 0));
    n += a.*p < least;
  }
  return n / 1000;
}

// A measurement with 50 samples tells how many suffice; a third of those do not.
TEST(power, of_a_size_is_what_was_asked_for) {
  constexpr int kSeeds = 50;
  constexpr double kAt = 50, kLeast = 1e-3;
  for (const double bias : {0.003, 0.0}) {
    const double in_places = bias > 0 ? 0 : 0.01;
    double z = 0, rms = 0;
    for (uint64_t s = 0; s < kSeeds; ++s) {
      const Agreement a =
          compare(runs_of(9000 + 2 * s, kAt, bias, in_places), runs_of(9001 + 2 * s, kAt, 0, 0));
      z += a.drift_z / kSeeds, rms += a.rms_z * a.rms_z / kSeeds;
    }
    const auto p = bias > 0 ? &Agreement::p_drift : &Agreement::p_rms;
    const double samples = bias > 0 ? samples_by_drift(kAt, z, 30, {kLeast, 0.99})
                                    : samples_by_rms(kAt, std::sqrt(rms), 48, {kLeast, 0.99});
    EXPECT_GE(seen(samples, bias, in_places, p, kLeast), 0.98) << bias;
    EXPECT_LT(seen(samples / 3, bias, in_places, p, kLeast), 0.9) << bias;
    EXPECT_LE(seen(samples, 0, 0, p, kLeast), 0.005) << bias;
  }
}

}  // namespace tdpt::testing::power_test
