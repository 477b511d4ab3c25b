// For tests: the mean of a picture and its standard error, from independent runs.
#pragma once
#include <gtest/gtest.h>

#include "libcommon/testing/statistics/power.h"
#include "tools/tdpt-render/testing/renderer.h"

namespace tdpt {

struct MeanAndError {
  double mean, error;  ///< luminance; standard error from independent runs
  /// Deviation in standard errors, with an allowance for rounding.
  double z(double expected) const {
    return std::abs(mean - expected) / std::hypot(error, 1e-5 * expected);
  }
};

inline MeanAndError mean_and_error(const std::vector<double>& runs) {
  double sum = 0, squares = 0;
  for (const double m : runs) sum += m, squares += m * m;
  const auto n = static_cast<double>(runs.size());
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1))};
}

/// Rendered as pictures are.
inline MeanAndError rendered(const Vista& vista, const Integrator& integrator, uint64_t spp,
                             uint64_t runs = 16, int max_depth = kMaxDepth) {
  std::vector<double> means;
  const auto renderer = renderer_under_test(vista);
  for (uint64_t seed = 1; seed <= runs; ++seed) {
    Job settings;
    settings.limits.spp = spp;
    settings.seed = testing::fresh(seed);
    settings.max_depth = max_depth;
    const RenderResult r = render(*renderer, integrator, settings);
    EXPECT_EQ(r.tally.not_finite, 0u);
    means.push_back(luminance(Rgb(r.mean())));
  }
  return mean_and_error(means);
}

}  // namespace tdpt
