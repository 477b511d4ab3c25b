#include "libcommon/denoise/regression.h"

#include <gtest/gtest.h>

#include "libcommon/testing/scenes/noisy_picture.h"

namespace tdpt::denoise {
namespace regression_test {
namespace {

struct Case {
  TestPicture picture;
  Colour none, wide;
  Plane all_present;
  Case() {
    for (size_t c = 0; c < 3; ++c) {
      none[c].assign(TestPicture::kSize.pixels(), 0);
      wide[c].assign(TestPicture::kSize.pixels(), 1);
    }
  }
  Colour estimate(const Colour& data, const Colour& guide) const {
    const std::array bandwidth{1.0f};
    const Source source{data, picture.features, guide, none, wide, all_present};
    return regressions(TestPicture::kSize, {&source, 1}, {1, 1e-9f}, bandwidth)[0];
  }
};

// The same estimates by loops over the definition, in double.
double slow_estimate(const Case& all, const Colour& data, const Colour& guide, int px, int py) {
  constexpr int kTerms = 8, kSide = 2 * kReach + 1;
  const int width = TestPicture::kSize.width, height = TestPicture::kSize.height;
  const auto at = [&](const Plane& plane, int x, int y) {
    x = std::clamp(x, 0, width - 1);
    y = std::clamp(y, 0, height - 1);
    return static_cast<double>(plane[static_cast<size_t>(y * width + x)]);
  };
  double m[kTerms][kTerms + 1] = {}, weights = 0, most_alike = 1e-6;
  // The pixel itself comes last: its weight is that of the neighbour that is most alike.
  for (int k = 0; k <= kSide * kSide; ++k) {
    const bool own = k == kSide * kSide;
    const int dx = own ? 0 : k % kSide - kReach, dy = own ? 0 : k / kSide - kReach;
    const int qx = px + dx, qy = py + dy;
    if (qx < 0 || qy < 0 || qx >= width || qy >= height || (!own && dx == 0 && dy == 0)) continue;
    double d = 0;
    for (int v = -1; v <= 1; ++v)
      for (int u = -1; u <= 1; ++u)
        for (size_t c = 0; c < 3; ++c) {
          const double off = at(guide[c], px + u, py + v) - at(guide[c], qx + u, qy + v);
          d += off * off / 2 / 27;
        }
    const double alike = d < 8 ? std::pow(1 - d / 8, 8) : 0;
    if (!own) most_alike = std::max(most_alike, alike);
    const double w = own ? most_alike : alike * std::exp(-(dx * dx + dy * dy) / 32.0);
    double f[kTerms] = {1};
    for (size_t j = 0; j < kFeatures; ++j)
      f[j + 1] = at(all.picture.features[j], qx, qy) - at(all.picture.features[j], px, py);
    for (int r = 0; r < kTerms; ++r) {
      for (int s = 0; s < kTerms; ++s) m[r][s] += w * f[r] * f[s];
      m[r][kTerms] += w * f[r] * at(data[0], qx, qy);
    }
    weights += w;
  }
  for (int r = 1; r < kTerms; ++r) m[r][r] += 1e-4 * weights;
  for (int r = kTerms - 1; r > 0; --r)  // Gauss, from the last term up
    for (int s = 0; s < r; ++s) {
      const double factor = m[s][r] / m[r][r];
      for (int k = 0; k <= kTerms; ++k) m[s][k] -= factor * m[r][k];
    }
  return std::max(0.0, m[0][kTerms] / m[0][0]);
}

TEST(Regression, AgreesWithTheDefinition) {
  const Case all;
  const Input noisy = all.picture.halves(0.7);
  const Colour estimate = all.estimate(noisy.halves.a, noisy.halves.b);
  for (const int y : {0, 1, 15, 16, 35, 36, 63})
    for (const int x : {0, 3, 31, 32, 50, 94, 95}) {
      const double slow = slow_estimate(all, noisy.halves.a, noisy.halves.b, x, y);
      EXPECT_NEAR(estimate[0][static_cast<size_t>(y * 96 + x)], slow, 2e-3 * (slow + 0.1))
          << x << ' ' << y;
    }
}

}  // namespace
}  // namespace regression_test
}  // namespace tdpt::denoise
