// A picture made of a formula, with noise and features, for tests.
#pragma once
#include <cmath>

#include "libcommon/denoise/denoise.h"
#include "libcommon/math/rng.h"

namespace tdpt::denoise {

/// A wall with a texture in its upper half, below a border another wall with another normal; the
/// light falls off smoothly.
class TestPicture {
 public:
  static constexpr Size kSize{96, 64};

  TestPicture() {
    for (Plane& plane : truth) plane.resize(kSize.pixels());
    for (Plane& plane : features) plane.resize(kSize.pixels());
    for (size_t i = 0; i < kSize.pixels(); ++i) {
      const auto x = static_cast<float>(i % 96), y = static_cast<float>(i / 96);
      const bool upper = y < 36;
      const float light = 0.2f + std::exp(-x / 40) * (upper ? 1.0f : 0.5f);
      for (size_t c = 0; c < 3; ++c) {
        const float texture = upper && (i / 3 + i / 96) % 2 == 0 ? 0.3f : 0.8f;
        features[c][i] = texture - 0.1f * static_cast<float>(c);
        truth[c][i] = features[c][i] * light;
      }
      features[3][i] = upper ? 1 : 0;
      features[4][i] = upper ? 0 : 1;
      features[6][i] = 0.5f;
    }
  }

  /// Two independent halves; the noise of each has this deviation relative to the truth and is
  /// skewed, as that of light is.
  Input halves(double noise, uint64_t seed = 1) const {
    Input input{kSize, {truth, truth, 0.5, features}};
    for (Colour* half : {&input.halves.a, &input.halves.b})
      for (size_t i = 0; i < kSize.pixels(); ++i) {
        // Exponential, with mean 1 and deviation 1.
        const double u =
            unit_double(mix64(mix64(i + (half == &input.halves.a ? 1000000 : 0)) + seed));
        const auto factor = static_cast<float>(1 + noise * (-std::log(1 - u) - 1));
        for (Plane& plane : *half) plane[i] *= factor;
      }
    return input;
  }

  /// Mean squared error relative to the truth.
  double error(const Colour& picture) const {
    double sum = 0;
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < kSize.pixels(); ++i) {
        const double off =
            static_cast<double>(picture[c][i]) / static_cast<double>(truth[c][i]) - 1;
        sum += off * off;
      }
    return sum / static_cast<double>(3 * kSize.pixels());
  }
  static double mean(const Colour& picture) {
    double sum = 0;
    for (const Plane& plane : picture)
      for (const float v : plane) sum += static_cast<double>(v);
    return sum / static_cast<double>(3 * kSize.pixels());
  }
  static Colour noisy(const Input& input) {
    Colour all = input.halves.a;
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < kSize.pixels(); ++i)
        all[c][i] = 0.5f * (input.halves.a[c][i] + input.halves.b[c][i]);
    return all;
  }

  Colour truth;
  Features features;
};

}  // namespace tdpt::denoise
