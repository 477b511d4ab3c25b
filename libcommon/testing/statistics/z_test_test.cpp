// The z-test itself: its false alarms and its power. Data resemble renderings: 48 blocks of
// different brightness, 16 runs; a value is the mean of many samples.
#include "libcommon/testing/statistics/z_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libcommon/math/rng.h"

namespace tdpt::testing::z_test_test {

constexpr size_t kBlocks = 48, kRuns = 16;

double normal(Rng& rng) {
  const double u = 1 - rng.uniform();
  const double v = rng.uniform();
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

double brightness(size_t block) {
  return 0.05 + static_cast<double>(block % 12);
}

/// Noise of a block's value around 1.
using Noise = double (*)(Rng&);

double gaussian_10_percent(Rng& rng) {
  return 1 + 0.1 * normal(rng);
}
double gaussian_3_percent(Rng& rng) {
  return 1 + 0.03 * normal(rng);
}
/// Mean of 300 samples: one in 30 is not zero, and is 30 times a lognormal factor of mean 1 (sigma
/// 1).
double sparse(Rng& rng) {
  double sum = 0;
  for (int i = 0; i < 300; ++i)
    if (rng.uniform() < 1.0 / 30) sum += 30 * std::exp(normal(rng) - 0.5);
  return sum / 300;
}
/// The same with one sample in 6: a relative deviation of 0.23 per run.
double skewed(Rng& rng) {
  double sum = 0;
  for (int i = 0; i < 300; ++i)
    if (rng.uniform() < 1.0 / 6) sum += 6 * std::exp(normal(rng) - 0.5);
  return sum / 300;
}
/// Mean of 300 samples, Pareto with exponent 2.5: no third moment. Mean 5/3 before division.
double fireflies(Rng& rng) {
  double sum = 0;
  for (int i = 0; i < 300; ++i) sum += std::pow(1 - rng.uniform(), -1 / 2.5);
  return sum / 300 / (5.0 / 3);
}

/// `bias(block)` multiplies the mean; `common`: share of the noise that all blocks of a run have in
/// common.
BlockRuns runs_of(uint64_t seed, Noise noise, double (*bias)(size_t) = nullptr, double common = 0) {
  BlockRuns out;
  for (size_t r = 0; r < kRuns; ++r) {
    Rng rng(seed, 0, r);
    const double shared = common * (noise(rng) - 1);
    std::vector<double> values(kBlocks);
    for (size_t b = 0; b < kBlocks; ++b)
      values[b] = brightness(b) * (bias ? bias(b) : 1) * std::max(noise(rng) + shared, 0.0);
    out.add(values);
  }
  return out;
}

struct Alarms {
  double drift = 0, rms = 0, largest = 0;  ///< share of trials with p below `at`
};
Alarms false_alarms(Noise first, Noise second, double at, int trials, double common = 0) {
  Alarms out;
  for (int i = 0; i < trials; ++i) {
    const auto seed = static_cast<uint64_t>(i);
    const Agreement a = compare(runs_of(2 * seed, first, nullptr, common),
                                runs_of(2 * seed + 1, second, nullptr, common));
    out.drift += (a.p_drift < at) * 1.0 / trials;
    out.rms += (a.p_rms < at) * 1.0 / trials;
    out.largest += (a.p_largest < at) * 1.0 / trials;
  }
  std::printf("p < %g in %d trials: drift %g, rms %g, largest %g\n", at, trials, out.drift, out.rms,
              out.largest);
  return out;
}

TEST(z_test, probabilities_are_what_they_say_for_gaussian_data) {
  const Alarms a = false_alarms(gaussian_10_percent, gaussian_10_percent, 0.05, 4000);
  for (double share : {a.drift, a.rms, a.largest}) EXPECT_NEAR(share, 0.05, 0.015);
}

TEST(z_test, the_drift_keeps_its_probability_when_blocks_of_a_run_depend_on_each_other) {
  EXPECT_NEAR(false_alarms(gaussian_10_percent, gaussian_10_percent, 0.05, 4000, 0.5).drift, 0.05,
              0.015);
}

TEST(z_test, no_false_alarm_in_thousands_of_pictures) {
  for (Noise noise : {gaussian_10_percent, skewed, sparse, fireflies})
    for (Noise other : {gaussian_3_percent, noise}) {
      // Of a thousand: two if all light comes from ten samples per block and run, none elsewhere.
      const Alarms a = false_alarms(noise, other, Agreement::kLeast, 300);
      EXPECT_LE(a.drift + a.rms + a.largest, noise == sparse ? 0.01 : 0);
    }
}

/// How many of 50 pictures with 3 % noise per block and run are rejected.
int caught(double (*bias)(size_t), bool (*by)(const Agreement&)) {
  int n = 0;
  for (uint64_t seed = 0; seed < 50; ++seed)
    n += by(
        compare(runs_of(seed, gaussian_3_percent), runs_of(seed + 100, gaussian_3_percent, bias)));
  return n;
}

TEST(z_test, twin_a_bias_of_2_percent_is_found) {
  EXPECT_EQ(caught([](size_t) { return 1.02; }, [](const Agreement& a) { return !a.holds(); }), 50);
}

TEST(z_test, twin_a_bias_up_here_and_down_there_is_found) {
  EXPECT_EQ(caught([](size_t b) { return b % 2 ? 1.03 : 0.97; },
                   [](const Agreement& a) { return a.p_rms < Agreement::kLeast; }),
            50);
}

TEST(z_test, twin_one_wrong_block_is_found) {
  EXPECT_EQ(caught([](size_t b) { return b == 17 ? 1.15 : 1.0; },
                   [](const Agreement& a) { return a.p_largest < Agreement::kLeast; }),
            50);
}

/// Two pictures that share their noise except for what `own` adds to each.
Agreement paired(uint64_t seed, Noise own, double size, double bias) {
  const BlockRuns common = runs_of(seed, gaussian_10_percent);
  BlockRuns first, second;
  for (size_t r = 0; r < kRuns; ++r) {
    Rng rng(seed, 1, r);
    std::vector<double> x = common.run(r), y = x;
    for (size_t b = 0; b < kBlocks; ++b) {
      x[b] += brightness(b) * (size * (own(rng) - 1) + bias);
      y[b] += brightness(b) * size * (own(rng) - 1);
    }
    first.add(x);
    second.add(y);
  }
  return compare_paired(first, second);
}

TEST(z_test, pairs_see_a_bias_far_below_their_common_noise) {
  for (uint64_t seed = 0; seed < 50; ++seed)
    EXPECT_LT(paired(seed, gaussian_10_percent, 0.01, 1e-3).p_drift, Agreement::kLeast);
}

TEST(z_test, no_false_alarm_in_hundreds_of_pairs) {
  for (Noise own : {gaussian_10_percent, skewed, sparse, fireflies}) {
    int alarms = 0, by_chance = 0;
    for (uint64_t seed = 0; seed < 300; ++seed) {
      const Agreement a = paired(seed, own, 0.05, 0);
      alarms += !a.holds();
      by_chance += a.p_drift < 0.05;
    }
    EXPECT_EQ(alarms, 0);
    EXPECT_NEAR(by_chance / 300.0, 0.05, 0.04);
  }
}

TEST(z_test, twin_a_picture_that_stays_black_is_found) {
  BlockRuns black;
  for (size_t r = 0; r < kRuns; ++r) black.add(std::vector<double>(kBlocks, 0));
  EXPECT_FALSE(compare(runs_of(1, sparse), black).holds());
  EXPECT_TRUE(compare(black, black).holds());
}

TEST(z_test, welch_z_is_that_of_a_table) {
  // t = 1 / sqrt(0.5) with 2 and 2 values 1 apart: t = sqrt 2, 2 degrees of freedom, one-sided p =
  // 0.1464, which is z = 1.052 of the normal distribution.
  const Difference d = difference({1, 2}, {0, 1});
  EXPECT_DOUBLE_EQ(d.first - d.second, 1);
  EXPECT_NEAR(d.z, 1.052, 5e-4);
}

TEST(z_test, means_that_differ_by_rounding_agree) {
  EXPECT_LT(std::abs(difference({1, 1}, {1 + 1e-7, 1 + 1e-7}).z), 1);
  EXPECT_GT(std::abs(difference({1, 1, 1, 1}, {1.1, 1.1, 1.1, 1.1}).z), 5);
}

}  // namespace tdpt::testing::z_test_test
