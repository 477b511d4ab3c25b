// Elementary functions and scaled numbers keep their stated bounds.
#include <cmath>

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "shaders/shared/elementary.h"
#include "shaders/shared/scaled.h"

namespace tdpt::shader::elementary_test {

// Largest of error(x) over `n` floats of [low, high].
template <class Error>
double worst(double low, double high, Error error) {
  double most = 0;
  tdpt::Rng rng(1, 0, 0);
  for (int i = 0; i < 1 << 18; ++i)
    most = std::max(most, error(static_cast<float>(low + (high - low) * rng.uniform())));
  return most;
}
double relative(double found, double exact) {
  return std::abs(found - exact) / std::abs(exact);
}

TEST(elementary, keeps_to_its_bounds) {
  EXPECT_LT(worst(-87, 88, [](float x) { return relative(exponential(x), std::exp(double{x})); }),
            2e-7);
  EXPECT_LT(worst(-36, 36,
                  [](float d) {
                    const auto x = static_cast<float>(std::pow(10.0, d));
                    return std::abs(logarithm(x) - std::log(double{x})) /
                           std::max(std::abs(std::log(double{x})), std::abs(x - 1.0));
                  }),
            2e-7);
  EXPECT_LT(worst(0.5, 2,
                  [](float x) {
                    return std::abs(logarithm(x) - std::log(double{x})) /
                           std::max(std::abs(x - 1.0), 1e-9);
                  }),
            2e-7);
  EXPECT_LT(worst(1e-4, 1, [](float x) { return relative(power(x, 7.3f), std::pow(x, 7.3f)); }),
            2e-5);
  EXPECT_LT(worst(0, 1, [](float t) { return relative(power(0.7f, t), std::pow(0.7f, t)); }), 4e-7);
  EXPECT_LT(worst(-0.5, 0.5,
                  [](float t) {
                    const double angle = 2 * std::numbers::pi * t, r = std::exp(8 * t);
                    const auto x = static_cast<float>(r * std::cos(angle)),
                               y = static_cast<float>(r * std::sin(angle));
                    return std::abs(turns_of(y, x) -
                                    std::atan2(double{y}, double{x}) / (2 * std::numbers::pi));
                  }),
            6e-8);
}

TEST(elementary, holds_at_the_ends) {
  EXPECT_EQ(exponential(-1e30f), 0.0f);
  EXPECT_EQ(exponential(1e30f), 3e38f);
  EXPECT_EQ(exponential(0.0f), 1.0f);
  EXPECT_EQ(logarithm(1.0f), 0.0f);
  EXPECT_EQ(power(0.0f, 2.0f), 0.0f);
  EXPECT_EQ(power(0.0f, 0.0f), 1.0f);
  EXPECT_EQ(turns_of(0.0f, 0.0f), 0.0f);
  EXPECT_EQ(turns_of(0.0f, 1.0f), 0.0f);
  EXPECT_EQ(turns_of(1.0f, 0.0f), 0.25f);
  EXPECT_EQ(std::abs(turns_of(0.0f, -1.0f)), 0.5f);
}

TEST(scaled, goes_beyond_floats_and_comes_back) {
  Scaled p = scaled(3.0f);
  for (int i = 0; i < 40; ++i) p = product(p, 1e-30f);
  EXPECT_EQ(narrowed(p), 0.0f);
  for (int i = 0; i < 40; ++i) p = quotient(p, scaled(1e-30f));
  EXPECT_NEAR(narrowed(p), 3, 1e-4);
  EXPECT_EQ(narrowed(product(scaled(1e30f), 1e30f)), 3e38f);
}

TEST(scaled, adds_what_differs_in_size) {
  EXPECT_EQ(narrowed(sum(scaled(1.0f), scaled(2.0f))), 3.0f);
  EXPECT_EQ(narrowed(sum(scaled(0.0f), scaled(2.0f))), 2.0f);
  EXPECT_EQ(narrowed(sum(scaled(2.0f), scaled(1e-36f))), 2.0f);
  EXPECT_EQ(narrowed(sum(scaled(1e-36f), scaled(2e36f))), 2e36f);
  EXPECT_EQ(narrowed(scaled(1e-40f)), 0.0f);
  EXPECT_TRUE(std::isnan(narrowed(sum(scaled(NAN), scaled(1.0f)))));
}

}  // namespace tdpt::shader::elementary_test
