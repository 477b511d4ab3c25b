// Synthetic pictures: pixels with log-normal samples, so that the truth is known.
#include "tools/tdpt-render/plan/noise.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace tdpt::error_estimate_test {

class Synthetic {
 public:
  Synthetic(size_t pixels, double sigma) : sigma_(sigma) {
    for (size_t i = 0; i < pixels; ++i)
      truth_.push_back(std::exp(2.0 * static_cast<double>(i) / static_cast<double>(pixels)));
    for (const double r : truth_) mean_ += r / static_cast<double>(pixels);
  }

  size_t pixels() const { return truth_.size(); }
  double mean() const { return mean_; }
  std::vector<Vec3d> sums(uint64_t samples, std::mt19937_64& random) const {
    std::normal_distribution<double> normal;
    std::vector<Vec3d> sums;
    for (const double r : truth_) {
      double sum = 0;
      for (uint64_t s = 0; s < samples; ++s)
        sum += r * std::exp(sigma_ * normal(random) - sigma_ * sigma_ / 2);
      sums.emplace_back(sum, sum, sum);
    }
    return sums;
  }
  std::vector<Rgb> picture(uint64_t samples, std::mt19937_64& random) const {
    std::vector<Rgb> picture;
    for (const Vec3d& s : sums(samples, random))
      picture.emplace_back(Vec3f(s * (1 / static_cast<double>(samples))));
    return picture;
  }
  double denominator(size_t i) const { return truth_[i] * truth_[i] + 0.01 * mean_ * mean_; }
  // Expected relMSE of one sample.
  double relmse() const {
    double sum = 0;
    for (size_t i = 0; i < pixels(); ++i)
      sum += truth_[i] * truth_[i] * std::expm1(sigma_ * sigma_) / denominator(i);
    return sum / static_cast<double>(pixels());
  }
  // Of that picture, as exrdiff reports it.
  double relmse(const std::vector<Rgb>& picture) const {
    double sum = 0;
    for (size_t i = 0; i < pixels(); ++i) {
      const double off = static_cast<double>(picture[i].x) - truth_[i];
      sum += off * off / denominator(i);
    }
    return sum / static_cast<double>(pixels());
  }

 private:
  double sigma_, mean_ = 0;
  std::vector<double> truth_;
};

// Mean estimate over the true relMSE of a part; `shared`: the parts share their random numbers.
double estimate_over_truth(uint64_t samples, uint64_t count, bool shared) {
  const Synthetic scene(512, 1);
  double mean = 0;
  constexpr int kRuns = 20;
  std::mt19937_64 random(1);
  for (int run = 0; run < kRuns; ++run) {
    PictureParts parts;
    const std::mt19937_64 start = random;
    for (uint64_t k = 0; k < count; ++k) {
      if (shared) random = start;
      parts.push_back(scene.picture(samples, random));
    }
    mean += estimate_error(parts, samples).relmse / kRuns;
  }
  return mean / (scene.relmse() / static_cast<double>(samples));
}

TEST(error_estimate, is_that_of_independent_parts) {
  EXPECT_NEAR(estimate_over_truth(4, 8, false), 1, 0.1);
  EXPECT_NEAR(estimate_over_truth(16, 4, false), 1, 0.1);
  EXPECT_LT(estimate_over_truth(4, 8, true), 0.1);  // twin
  const ErrorEstimate black = estimate_error(PictureParts(8, std::vector<Rgb>(4, Rgb(0))), 1);
  EXPECT_FALSE(black.lit);
  EXPECT_EQ(black.relmse, 0);
}

TEST(error_estimate, is_finite_from_faint_to_bright) {
  for (const float scale : {1e-30f, 1e30f}) {
    PictureParts parts;
    for (int k = 0; k < 4; ++k)
      parts.push_back({Rgb(scale * (1 + static_cast<float>(k))), Rgb(0), Rgb(scale)});
    const ErrorEstimate e = estimate_error(parts, 1);
    EXPECT_TRUE(e.lit);
    EXPECT_GT(e.relmse, 0.01);
    EXPECT_LT(e.relmse, 10);
  }
}

// Pictures of as many samples as a pilot fixes. `naive`: the pilot divides by the squares of the
// parts' own noisy pixels.
struct Coverage {
  double met = 0, median = 0;  ///< share of pictures; target over their relMSE
};
Coverage coverage(size_t pixels, double sigma, double target, bool naive) {
  const Synthetic scene(pixels, sigma);
  std::mt19937_64 random(7);
  std::vector<double> better;
  constexpr size_t kPictures = 200;
  for (size_t n = 0; n < kPictures; ++n) {
    PictureParts last(kErrorPilotParts);
    const ErrorPilot pilot =
        run_error_pilot(pixels, target, 1 << 20, [&](uint64_t part, const SampleRange& samples) {
          std::vector<Vec3d> sums = scene.sums(samples.count, random);
          last[part].clear();
          for (const Vec3d& s : sums)
            last[part].emplace_back(Vec3f(s * (1 / static_cast<double>(samples.count))));
          return std::optional(sums);
        });
    uint64_t samples = pilot.needed;
    if (naive) {
      double sum = 0;
      for (size_t i = 0; i < pixels; ++i) {
        const auto a = static_cast<double>(last[0][i].x), b = static_cast<double>(last[1][i].x);
        const double own = (a * a + b * b) / 2;
        sum += (a - b) * (a - b) / 2 / (own + 0.01 * scene.mean() * scene.mean());
      }
      const double each = static_cast<double>((pilot.estimate.samples + 1) / 2);
      samples = static_cast<uint64_t>(std::ceil(each * sum / static_cast<double>(pixels) / target));
    }
    better.push_back(target / scene.relmse(scene.picture(samples, random)));
  }
  std::sort(better.begin(), better.end());
  const auto met = std::count_if(better.begin(), better.end(), [](double b) { return b >= 1; });
  return {static_cast<double>(met) / kPictures, better[kPictures / 2]};
}

TEST(error_estimate, nine_of_ten_pictures_meet_their_target) {
  const Coverage calm = coverage(256, 0.5, 0.01, false), heavy = coverage(256, 1.2, 0.05, false);
  std::printf("calm %.3f %.2f, heavy-tailed %.3f %.2f\n", calm.met, calm.median, heavy.met,
              heavy.median);
  EXPECT_GE(calm.met, 0.9);
  EXPECT_GE(heavy.met, 0.9);
  EXPECT_LE(calm.median, 2.5);
  EXPECT_LE(heavy.median, 2.5);
  EXPECT_GE(coverage(1, 1, 0.01, false).met, 0.9);  // of one pixel
}
TEST(error_estimate, twin_an_error_over_the_noisy_picture_itself) {
  EXPECT_LT(coverage(256, 1.2, 0.05, true).met, 0.8);
}

TEST(error_estimate, samples_are_few_bits_and_enough) {
  ErrorEstimate e{true, 1, 0, 1e6, 1};
  EXPECT_EQ(samples_needed(e, 8, 1e9), 1u);
  EXPECT_EQ(samples_needed(e, 8, 1e-12), uint64_t{1} << 32);
  for (double target = 0.5; target > 1e-7; target *= 0.77) {
    const uint64_t n = samples_needed(e, 8, target);
    EXPECT_GE(static_cast<double>(n), 1 / target);
    EXPECT_LE(static_cast<double>(n), 1.3 / target + 2);
    uint64_t m = n;
    while (m % 2 == 0) m /= 2;
    EXPECT_LT(m, 16u) << n;
  }
  // The error of one-pixel pictures scatters more than that of large ones.
  e.pixels = 1;
  EXPECT_GT(samples_needed(e, 8, 0.01), 300u);
  e.pixels = 1e6;
  e.spread = 0.3;
  EXPECT_GT(samples_needed(e, 8, 0.01), 150u);
  e.relmse = 0;
  EXPECT_EQ(samples_needed(e, 8, 0.01), 1u);
}

TEST(error_estimate, blocks_of_a_picture_double_in_size) {
  PictureBlocks blocks;
  std::vector<uint64_t> ends;
  for (uint64_t n = 1; n <= 60; ++n) {
    if (n != blocks.next()) continue;
    ends.push_back(n);
    const auto s = static_cast<double>(n * n);  // sample i brings 2 i - 1
    blocks.add({Vec3d(s, s, s)});
    ASSERT_LT(blocks.blocks().size(), 8u);
    for (size_t b = 0; b < blocks.blocks().size(); ++b)
      EXPECT_FLOAT_EQ(blocks.blocks()[b][0].x, static_cast<float>(blocks.size() * (2 * b + 1)));
  }
  EXPECT_EQ(ends, (std::vector<uint64_t>{1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40,
                                         48, 56}));
}

}  // namespace tdpt::error_estimate_test
