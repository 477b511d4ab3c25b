// Tests of the tests: what the statistics say of data whose distribution is known, and what they
// see of planted faults.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "libcommon/formats/picture.h"
#include "libcommon/math/rng.h"
#include "libcommon/testing/failures_elsewhere.h"
#include "libcommon/testing/files/read_png.h"
#include "libcommon/testing/statistics/chi_square.h"
#include "libcommon/testing/statistics/power.h"
#include "libcommon/testing/statistics/z_failure.h"

namespace tdpt::testing::statistics_test {

double p_of_die(double loaded) {
  return chi_square_of_samples(
             60000, std::vector<double>(6, 1.0 / 6),
             [&](uint64_t i) {
               Rng rng(1, 0, i);
               const double u = rng.uniform();
               return u < loaded ? size_t{0} : std::min(size_t{5}, static_cast<size_t>(u * 6));
             })
      .p;
}

TEST(chi_square, has_the_quantiles_of_tables_and_sees_a_loaded_die) {
  EXPECT_NEAR(chi_square_p(3.841, 1), 0.05, 1e-4);
  EXPECT_NEAR(chi_square_p(135.807, 100), 0.01, 1e-4);
  EXPECT_EQ(chi_square_p(7, 0), 1);
  EXPECT_NEAR(binomial_p(0, 10, 0.5), 2 / 1024.0, 1e-12);
  EXPECT_NEAR(binomial_p(9, 10, 0.5), 22 / 1024.0, 1e-12);
  EXPECT_EQ(binomial_p(1, 10, 0), 0);
  EXPECT_NEAR(sidak(0.01, 20), 5.0239e-4, 1e-7);
  EXPECT_GT(p_of_die(0), 0.01);
  EXPECT_LT(p_of_die(1.1 / 6), 1e-4);
  // Rare bins are pooled, impossible ones fail, and so do probabilities above 1.
  EXPECT_EQ(chi_square({50, 1, 1, 1, 1, 1}, {50, 1, 1, 1, 1, 1}).bins, 2u);
  EXPECT_EQ(chi_square({50, 6}, {56, 0}).p, 0);
  const auto alternating = [](uint64_t i) { return size_t{i % 2}; };
  EXPECT_EQ(chi_square_of_samples(1000, {0.5, 0.5}, alternating).p, 1);
  EXPECT_EQ(chi_square_of_samples(1000, {0.51, 0.51}, alternating).p, 0);
}

TEST(chi_square, bins_cover_the_sphere_once_and_quadrature_follows_edges_and_peaks) {
  const auto uniform = [](const Vec3d&) { return 0.25 * std::numbers::inv_pi; };
  for (const SphereBins& bins :
       {SphereBins(6, 8), SphereBins(normalize(Vec3d(1, -2, 0.5)), 0.01, 10, 6)}) {
    const ChiSquare c = chi_square_of_samples(50000, bins.integrate(uniform), [&](uint64_t i) {
      Rng rng(3, 0, i);
      const double z = 2 * rng.uniform() - 1;
      const double phi = 2 * std::numbers::pi * rng.uniform();
      const double r = std::sqrt(1 - z * z);
      return bins.bin({r * std::cos(phi), r * std::sin(phi), z});
    });
    EXPECT_GT(c.p, 0.001);
  }
  const auto step = [](double x, double y) { return x * x + y * y < 0.5 ? 1.0 : 0.0; };
  EXPECT_NEAR(integrate(step, 0, 1, 0, 1), std::numbers::pi / 8, 1e-3 * std::numbers::pi / 8);
  const auto peak = [](double x, double y) {
    return std::exp(-1e3 * ((x - 0.4) * (x - 0.4) + (y - 0.3) * (y - 0.3)));
  };
  EXPECT_NEAR(integrate(peak, 0, 1, 0, 1), std::numbers::pi * 1e-3, 1e-9);
}

// ---- z-test: 16 runs of 48 blocks of different brightness, as renderings have them ----
double normal(Rng& rng) {
  const double u = 1 - rng.uniform();
  const double v = rng.uniform();
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}
/// Mean of 100 samples: one in 6 is not zero, and is 6 times a lognormal factor of mean 1.
double skewed(Rng& rng) {
  double sum = 0;
  for (int i = 0; i < 100; ++i)
    if (rng.uniform() < 1.0 / 6) sum += 6 * std::exp(0.6 * normal(rng) - 0.18);
  return sum / 100;
}

/// `bias(block)` multiplies the mean of what has 3 % noise, or is skewed.
BlockRuns runs_of(uint64_t seed, double (*bias)(size_t) = nullptr, bool skew = false) {
  BlockRuns out;
  for (uint64_t r = 0; r < 16; ++r) {
    Rng rng(seed, 0, r);
    std::vector<double> values(48);
    for (size_t b = 0; b < values.size(); ++b) {
      const double noise = skew ? skewed(rng) : 1 + 0.03 * normal(rng);
      values[b] = (0.05 + static_cast<double>(b % 12)) * (bias ? bias(b) : 1) * noise;
    }
    out.add(values);
  }
  return out;
}

TEST(z_test, has_its_probabilities_and_sees_each_kind_of_fault) {
  double drift = 0, rms = 0, largest = 0;
  constexpr int kTrials = 400;
  for (uint64_t k = 0; k < kTrials; ++k) {
    const Agreement a = compare(runs_of(2 * k), runs_of(2 * k + 1));
    drift += a.p_drift < 0.05, rms += a.p_rms < 0.05, largest += a.p_largest < 0.05;
    if (k % 10 == 0) {
      EXPECT_TRUE(compare(runs_of(k, nullptr, true), runs_of(k + 1)).holds()) << k;
    }
  }
  for (const double share : {drift, rms, largest}) EXPECT_NEAR(share / kTrials, 0.05, 0.03);
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const auto against = [&](double (*bias)(size_t)) {
      return compare(runs_of(seed), runs_of(seed + 100, bias));
    };
    EXPECT_FALSE(against([](size_t) { return 1.02; }).holds());
    EXPECT_LT(against([](size_t b) { return b % 2 ? 1.03 : 0.97; }).p_rms, Agreement::kLeast);
    EXPECT_LT(against([](size_t b) { return b == 17 ? 1.15 : 1.0; }).p_largest, Agreement::kLeast);
  }
  const auto black = [](size_t) { return 0.0; };
  EXPECT_FALSE(compare(runs_of(1), runs_of(2, black)).holds());
  EXPECT_TRUE(compare(runs_of(1, black), runs_of(2, black)).holds());
  // t = sqrt 2 with 2 degrees of freedom: one-sided p = 0.1464, which is z = 1.052.
  EXPECT_NEAR(difference({1, 2}, {0, 1}).z, 1.052, 5e-4);
  EXPECT_LT(std::abs(difference({1, 1}, {1 + 1e-7, 1 + 1e-7}).z), 1);  // rounding
}

TEST(z_test, pairs_see_a_bias_far_below_their_common_noise) {
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const BlockRuns first = runs_of(seed);
    BlockRuns second, biased;
    for (size_t r = 0; r < first.runs(); ++r) {
      Rng rng(seed, 1, r);
      std::vector<double> x = first.run(r), y = x;
      for (size_t b = 0; b < x.size(); ++b) {
        x[b] *= 1 + 1e-3 * normal(rng);
        y[b] = x[b] * 1.001;
      }
      second.add(x), biased.add(y);
    }
    EXPECT_TRUE(compare_paired(first, second).holds());
    EXPECT_LT(compare_paired(first, biased).p_drift, Agreement::kLeast);
  }
}

TEST(power, of_many_degrees_of_freedom_is_that_of_the_normal_distribution) {
  // 4.417 leaves 1e-5 outside on both sides, 3.090 leaves 1e-3 on one side.
  EXPECT_NEAR(least_shift(1e6), 4.417 + 3.090, 1e-3);
  EXPECT_NEAR(samples_by_drift(100, 2 * (4.417 + 3.090), 1e6), 25, 0.01);
  EXPECT_GT(least_shift(15), 1.3 * least_shift(1e6));
  // One block is a z without its sign.
  EXPECT_NEAR(std::sqrt(least_noncentrality(1)), least_shift(1e6), 1e-3);
  EXPECT_NEAR(samples_by_rms(8, std::sqrt(1 + least_noncentrality(48) / 48), 48), 8, 1e-6);
}

// Block 10 of the first is brighter, block 45 darker, and block 20 of the second is no number to
// ask.
TEST(z_failure, a_disagreement_leaves_its_pictures_z_map_and_p_values) {
  const FailuresElsewhere elsewhere;
  const auto spots = [](size_t b) { return b == 10 ? 1.3 : b == 45 ? 0.7 : 1.0; };
  const BlockRuns first = runs_of(1, spots);
  BlockRuns second;
  for (size_t r = 0; r < 16; ++r) {
    std::vector<double> blocks = runs_of(2).run(r);
    blocks[20] = r == 0 ? 5 : 0;
    second.add(blocks);
  }
  EXPECT_TRUE(holds(compare(first, first), "same", first, first, 8));
  EXPECT_FALSE(std::filesystem::exists(elsewhere.folder()));

  const Agreement agreement = compare(first, second);
  const ::testing::AssertionResult result = holds(agreement, "depth 3, a/b", first, second, 8);
  EXPECT_FALSE(result);
  const std::string begin = (failures_folder() / "depth_3__a_b").string();
  EXPECT_NE(std::string(result.message()).find(begin), std::string::npos) << result.message();
  const auto bytes_of = [&](const char* end) {
    std::ostringstream bytes;
    bytes << std::ifstream(begin + end, std::ios::binary).rdbuf();
    return bytes.str();
  };
  const Picture left = read_exr(begin + ".first.exr").picture;
  EXPECT_EQ(left.width, 8);
  EXPECT_NEAR(left.pixels[10].x, first.mean(10), 1e-5);
  EXPECT_NEAR(read_exr(begin + ".second.exr").picture.pixels[10].x, second.mean(10), 1e-5);
  const PngPixels map = read_png(bytes_of(".z.png"));
  ASSERT_EQ(map.width, 8 * 24);
  ASSERT_EQ(map.height, 6 * 24);
  const auto block = [&](int b) { return map.at(b % 8 * 24 + 12, b / 8 * 24 + 12); };
  EXPECT_EQ(block(10), (std::array<uint8_t, 3>{255, 0, 0}));
  EXPECT_EQ(block(45), (std::array<uint8_t, 3>{0, 0, 255}));
  EXPECT_EQ(block(20), (std::array<uint8_t, 3>{128, 128, 128}));
  EXPECT_GT(block(0)[1], 100);
  const std::string text = bytes_of(".txt");
  EXPECT_EQ(text.find(agreement.text()), 0u);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3 + 6);
}

}  // namespace tdpt::testing::statistics_test
