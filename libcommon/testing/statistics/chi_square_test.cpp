// Tests of the test: known quantiles, fair and loaded dice, densities that integrate to one.
#include "libcommon/testing/statistics/chi_square.h"

#include <gtest/gtest.h>
#include <numbers>

#include "libcommon/math/rng.h"

namespace tdpt::chi_square_test {

TEST(chi_square, probabilities_are_those_of_the_tables) {
  EXPECT_NEAR(chi_square_p(3.841, 1), 0.05, 1e-4);
  EXPECT_NEAR(chi_square_p(18.307, 10), 0.05, 1e-4);
  EXPECT_NEAR(chi_square_p(135.807, 100), 0.01, 1e-4);
  EXPECT_EQ(chi_square_p(7, 0), 1);
  EXPECT_NEAR(binomial_p(5, 10, 0.5), 1, 1e-12);
  EXPECT_NEAR(binomial_p(0, 10, 0.5), 2 / 1024.0, 1e-12);
  EXPECT_NEAR(binomial_p(9, 10, 0.5), 22 / 1024.0, 1e-12);
  EXPECT_EQ(binomial_p(1, 10, 0), 0);
  EXPECT_EQ(binomial_p(10, 10, 1), 1);
  EXPECT_NEAR(sidak(0.01, 20), 5.0239e-4, 1e-7);
}

double die(double loaded) {
  const std::vector<double> probability(6, 1.0 / 6);
  return chi_square_of_samples(
             60000, probability,
             [&](uint64_t i) {
               Rng rng(1, 0, i);
               const double u = rng.uniform();
               return u < loaded ? size_t{0} : std::min(size_t{5}, static_cast<size_t>(u * 6));
             })
      .p;
}
TEST(chi_square, a_fair_die_passes) {
  EXPECT_GT(die(0), 0.01);
}
TEST(chi_square, twin_a_loaded_die_fails) {
  EXPECT_LT(die(1.1 / 6), 1e-4);
}

TEST(chi_square, rare_bins_are_pooled_and_impossible_ones_fail) {
  const ChiSquare c = chi_square({50, 1, 1, 1, 1, 1}, {50, 1, 1, 1, 1, 1});
  EXPECT_EQ(c.bins, 2u);
  EXPECT_EQ(c.statistic, 0);
  EXPECT_EQ(chi_square({50, 6}, {56, 0}).p, 0);
  EXPECT_EQ(chi_square({51, 0}, {51, 0}).p, 1);
}

TEST(chi_square, probabilities_above_one_fail) {
  const auto all_equal = [](double p) {
    return chi_square_of_samples(1000, {p, p}, [](uint64_t i) { return size_t{i % 2}; }).p;
  };
  EXPECT_EQ(all_equal(0.5), 1);
  EXPECT_EQ(all_equal(0.51), 0);
}

// For a correct program p is uniform: small p-values occur with their nominal frequency.
TEST(chi_square, p_values_are_uniform) {
  int below = 0;
  for (uint64_t k = 0; k < 400; ++k)
    below += chi_square_of_samples(2000, std::vector<double>(16, 1.0 / 16), [&](uint64_t i) {
               Rng rng(2, k, i);
               return size_t{rng.below(16)};
             }).p < 0.1;
  EXPECT_GT(binomial_p(static_cast<uint64_t>(below), 400, 0.1), 0.001);
}

TEST(chi_square, bins_cover_the_sphere_once) {
  const SphereBins plain(6, 8), narrow(normalize(Vec3d(1, -2, 0.5)), 0.01, 10, 6);
  for (const SphereBins& bins : {plain, narrow}) {
    double sum = 0;
    for (double p : bins.integrate([](const Vec3d&) { return 0.25 * std::numbers::inv_pi; }))
      sum += p;
    EXPECT_NEAR(sum, 1, 1e-12);
  }
  const auto uniform = [](const Vec3d&) { return 0.25 * std::numbers::inv_pi; };
  for (const SphereBins& bins : {plain, narrow}) {
    const ChiSquare c = chi_square_of_samples(50000, bins.integrate(uniform), [&](uint64_t i) {
      Rng rng(3, 0, i);
      const double z = 2 * rng.uniform() - 1;
      const double phi = 2 * std::numbers::pi * rng.uniform();
      const double r = std::sqrt(1 - z * z);
      return bins.bin({r * std::cos(phi), r * std::sin(phi), z});
    });
    EXPECT_GT(c.p, 0.001);
  }
}

TEST(chi_square, quadrature_follows_edges_and_peaks) {
  const auto step = [](double x, double y) { return x * x + y * y < 0.5 ? 1.0 : 0.0; };
  EXPECT_NEAR(integrate(step, 0, 1, 0, 1), std::numbers::pi / 8, 1e-3 * std::numbers::pi / 8);
  const auto peak = [](double x, double y) {
    return std::exp(-1e3 * ((x - 0.4) * (x - 0.4) + (y - 0.3) * (y - 0.3)));
  };
  EXPECT_NEAR(integrate(peak, 0, 1, 0, 1), std::numbers::pi * 1e-3, 1e-9);
}

}  // namespace tdpt::chi_square_test
