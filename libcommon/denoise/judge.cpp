#include "libcommon/denoise/judge.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tdpt::denoise {
namespace {

// The light is filtered after division by the albedo plus this.
constexpr float kAlbedoOffset = 0.5f;
constexpr double kDark = 0.01;  // as in relMSE
// Deviations of filters [pixels]: of errors, of noise that tells how certain they are, of
// brightness, of the error that is reported.
constexpr double kErrorSmoothing = 3, kNoiseSmoothing = 9, kBrightnessSmoothing = 2,
                 kMapSmoothing = 5;
// The error is known of pictures with so many tiles, and so few outliers for each pixel; the truth
// is within that factor of it.
constexpr int kTile = 16;  // [pixels]
constexpr size_t kFewestTiles = 8;
constexpr double kMostOutliers = 0.01, kWithin = 2, kUnseen = 1.25;

}  // namespace

double mean_of(const Plane& plane) {
  double sum = 0;
  for (const float v : plane) sum += static_cast<double>(v);
  return sum / static_cast<double>(plane.size());
}
double mean_of(const Colour& colour) {
  return (mean_of(colour[0]) + mean_of(colour[1]) + mean_of(colour[2])) / 3;
}

Colour mean(const Colour& a, const Colour& b, float share_a) {
  Colour all = a;
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < all[c].size(); ++i)
      all[c][i] = share_a * a[c][i] + (1 - share_a) * b[c][i];
  return all;
}

void by_albedo(Colour& colour, Albedo how, const Features& features) {
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < colour[c].size(); ++i) {
      const float factor = features[c][i] + kAlbedoOffset;
      colour[c][i] = how == Albedo::divide ? colour[c][i] / factor : colour[c][i] * factor;
    }
}

Judge::Judge(Size size, const NoisyHalves& halves, double light)
    : size_(size), share_a_(static_cast<float>(halves.share_a)), noisy_(halves) {
  // Squared errors are relative to the brightness around, as in relMSE.
  per_ = mean(halves.a, halves.b, share_a_);
  by_albedo(per_, Albedo::multiply, halves.features);
  for (Plane& plane : per_) {
    plane = smooth(plane, size_, kBrightnessSmoothing);
    for (float& v : plane) {
      const auto bright = static_cast<double>(v);
      v = static_cast<float>(1 / (3 * (bright * bright + kDark * light * light)));
    }
  }
  by_albedo(per_, Albedo::multiply, halves.features);
  by_albedo(per_, Albedo::multiply, halves.features);
  noise_.resize(size.pixels());
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < noise_.size(); ++i) {
      const float difference = halves.a[c][i] - halves.b[c][i];
      noise_[i] += per_[c][i] * share_a_ * (1 - share_a_) * (difference * difference);
    }
  noise_ = smooth(noise_, size_, kNoiseSmoothing);
}

Plane Judge::share(const Halves& from, const Halves& to, double certain) const {
  const float s_a = share_a_, s_b = 1 - share_a_;
  Plane gain(size_.pixels()), squares(size_.pixels());
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < gain.size(); ++i) {
      const float d_a = to.a[c][i] - from.a[c][i], d_b = to.b[c][i] - from.b[c][i];
      const float d = s_a * d_a + s_b * d_b;
      gain[i] += per_[c][i] * (s_a * (noisy_.b[c][i] - from.a[c][i]) * d_a +
                               s_b * (noisy_.a[c][i] - from.b[c][i]) * d_b +
                               s_a * s_b * (from.a[c][i] - from.b[c][i]) * (d_a - d_b));
      squares[i] += per_[c][i] * (d * d);
    }
  gain = smooth_others(gain, size_, kErrorSmoothing);
  squares = smooth(squares, size_, kErrorSmoothing);
  // Number of pixels that the smoothing averages.
  const double n = 4 * std::numbers::pi * kErrorSmoothing * kErrorSmoothing;
  for (size_t i = 0; i < gain.size(); ++i) {
    const auto x = static_cast<double>(gain[i]), y = static_cast<double>(squares[i]);
    const double v = certain * certain * y * static_cast<double>(noise_[i]) / n;
    gain[i] = x > 0 && y > 0 ? static_cast<float>(std::clamp((x - v / x) / y, 0.0, 1.0)) : 0.0f;
  }
  return gain;
}

float Judge::squared_error(const Halves& f, size_t c, size_t i) const {
  const float s_a = share_a_, s_b = 1 - share_a_;
  const float noise = noisy_.a[c][i] - noisy_.b[c][i];
  const float v_a = s_b * (noise * noise), v_b = s_a * (noise * noise);
  const float off_a = f.a[c][i] - noisy_.b[c][i], off_b = f.b[c][i] - noisy_.a[c][i];
  const float difference = f.a[c][i] - f.b[c][i];
  return s_a * (off_a * off_a - v_b) + s_b * (off_b * off_b - v_a) -
         s_a * s_b * (difference * difference);
}

namespace {

// The squared error of each pixel, relative to the estimate itself, and the variance of the
// estimate, both by the halves; and the mean variance of the noise.
struct Squares {
  Plane error, variance;
  double noise = 0;
};
Squares squares_of(const Input& input, const Halves& f, double light) {
  const auto share_a = static_cast<float>(input.halves.share_a);
  const Judge judge(input.size, input.halves, light);
  Squares all{Plane(input.size.pixels()), Plane(input.size.pixels())};
  const Colour picture = mean(f.a, f.b, share_a);
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < all.error.size(); ++i) {
      const double albedo = static_cast<double>(input.halves.features[c][i] + kAlbedoOffset);
      const double bright = albedo * static_cast<double>(picture[c][i]);
      const auto per =
          static_cast<float>(albedo * albedo / (3 * (bright * bright + kDark * light * light)));
      const float difference = f.a[c][i] - f.b[c][i];
      all.error[i] += per * judge.squared_error(f, c, i);
      all.variance[i] += per * share_a * (1 - share_a) * difference * difference;
      const float noise = input.halves.a[c][i] - input.halves.b[c][i];
      all.noise += static_cast<double>(per * share_a * (1 - share_a) * noise * noise);
    }
  all.noise /= static_cast<double>(input.size.pixels());
  return all;
}

// Standard error of a plane's mean, by the means of tiles; nothing if those are few.
std::optional<double> deviation_of_mean(const Plane& plane, Size size) {
  const int across = size.width / kTile, down = size.height / kTile;
  const auto count = static_cast<size_t>(across) * static_cast<size_t>(down);
  if (count < kFewestTiles) return {};
  std::vector<double> tiles(count);
  for (int y = 0; y < down * kTile; ++y)
    for (int x = 0; x < across * kTile; ++x)
      tiles[static_cast<size_t>(y / kTile * across + x / kTile)] +=
          static_cast<double>(plane[size.index(x, y)]);
  const auto n = static_cast<double>(count);
  double mean = 0, squares = 0;
  for (const double t : tiles) mean += t / n;
  for (const double t : tiles) squares += (t - mean) * (t - mean);
  return std::sqrt(squares) / (n * kTile * kTile);
}

}  // namespace

void estimate_error(const Input& input, const Halves& f, double light, Result& result) {
  const Size size = input.size;
  const Squares squares = squares_of(input, f, light);
  const std::optional<double> deviation = deviation_of_mean(squares.error, size);
  if (!deviation ||
      static_cast<double>(result.outliers) > kMostOutliers * static_cast<double>(size.pixels()))
    return;
  const double kept = mean_of(squares.variance);
  const double lost = squares.noise > 0 ? std::max(1 - std::sqrt(kept / squares.noise), 0.0) : 0;
  const double relmse =
      kUnseen * (std::max(mean_of(squares.error), 0.0) + lost * kept) + *deviation / 2;
  result.left = {relmse, relmse / kWithin, relmse * kWithin};
  result.error = smooth(squares.error, size, kMapSmoothing);
  const Plane variance = smooth(squares.variance, size, kMapSmoothing);
  for (size_t i = 0; i < variance.size(); ++i)
    result.error[i] = std::max(result.error[i], 0.0f) + variance[i];
  const double sum = mean_of(result.error);
  for (float& v : result.error)
    v = sum > 0 ? std::sqrt(static_cast<float>(static_cast<double>(v) * relmse / sum)) : 0;
}

}  // namespace tdpt::denoise
