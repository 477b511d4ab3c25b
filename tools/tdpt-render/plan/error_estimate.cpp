#include "tools/tdpt-render/plan/error_estimate.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace tdpt {
namespace {

constexpr double kDark = 0.01;  // as exrdiff's relMSE

double mean_magnitude(const PictureParts& parts) {
  double sum = 0;
  for (const auto& part : parts)
    for (const Rgb& p : part)
      for (int c = 0; c < 3; ++c) sum += std::abs(static_cast<double>(p[c]));
  return sum / (3 * static_cast<double>(parts.size() * parts[0].size()));
}

// Terms of one component of one pixel.
struct Told {
  double high = 0, low = 0, denominator = 1, sum = 0;
};

Told tell(const PictureParts& parts, size_t pixel, int c, double dark) {
  const auto x = [&](size_t k) { return static_cast<double>(parts[k][pixel][c]); };
  const size_t count = parts.size();
  const auto n = static_cast<double>(count);
  Told t;
  for (size_t k = 0; k < count; ++k) t.sum += x(k);
  const double m = t.sum / n;
  double v = 0;
  for (size_t k = 0; k < count; ++k) v += (x(k) - m) * (x(k) - m) / (n - 1);
  t.denominator = std::max(m * m - v / n, 0.0) + dark;
  t.low = v / t.denominator;
  for (size_t a = 0; count > 2 && a < count; ++a) {
    const size_t b = (a + 1) % count;
    const double d = x(a) - x(b), rest = (t.sum - x(a) - x(b)) / (n - 2);
    t.high += d * d / 2 / (rest * rest + dark) / n;
  }
  return t;
}

// Relative standard error of the mean of a small sample.
double relative_error(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double mean = 0, squares = 0;
  for (const double v : values) mean += v / n;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return mean > 0 ? std::sqrt(squares / (n - 1) / n) / mean : 0;
}

// Quantile of a gamma distribution of mean 1 and relative standard deviation `deviation`, for the
// standard normal's `z` (Wilson and Hilferty).
double quantile(double deviation, double z) {
  const double root = 1 - deviation * deviation / 9 + z * deviation / 3;
  return std::pow(std::max(root, 1.0), 3);
}

// The least m 2^j, m < 16, not below n.
uint64_t rounded_up(uint64_t n) {
  const int bits = static_cast<int>(std::bit_width(n));
  if (bits <= 4) return std::max<uint64_t>(n, 1);
  const uint64_t step = uint64_t{1} << (bits - 4);
  return (n + step - 1) / step * step;
}

}  // namespace

ErrorEstimate estimate_error(const PictureParts& parts) {
  ErrorEstimate e;
  const double mean = mean_magnitude(parts), n = static_cast<double>(parts.size());
  if (!(mean > 0)) return e;
  e.lit = true;
  const double dark = kDark * mean * mean;
  double high = 0, low = 0, squares = 0;
  std::vector<double> of_part(parts.size(), 0);
  for (size_t i = 0; i < parts[0].size(); ++i) {
    double of_pixel = 0;
    for (int c = 0; c < 3; ++c) {
      const Told t = tell(parts, i, c, dark);
      high += t.high;
      of_pixel += t.low;
      for (size_t k = 0; k < parts.size(); ++k) {
        const auto x = static_cast<double>(parts[k][i][c]);
        const double off = x - (t.sum - x) / (n - 1);
        of_part[k] += off * off / t.denominator;
      }
    }
    low += of_pixel;
    squares += of_pixel * of_pixel;
  }
  const auto pixels = static_cast<double>(parts[0].size());
  e.relmse = (parts.size() > 2 ? std::sqrt(high * low) : low) / (3 * pixels);
  if (!(low > 0)) return e;
  e.pixels = pixels;
  const double of_pixels = std::sqrt(std::max(0.0, squares / (low * low) - 1 / pixels));
  e.spread = std::max(relative_error(of_part), of_pixels);
  return e;
}

double interval_factor(const ErrorEstimate& estimate) {
  return std::exp(2 * std::min(estimate.spread, 2.0));
}

uint64_t samples_needed(const ErrorEstimate& estimate, uint64_t parts, uint64_t samples,
                        double target) {
  constexpr double kMost = 0x1p32, kNinetyFive = 1.645;
  constexpr double kMargin = 1.1;  // the estimate may be a tenth too small
  const double plain = static_cast<double>(samples) * estimate.relmse / target;
  if (!(plain > 0)) return 1;
  // Variance of the estimate, and of this picture about the mean of such pictures.
  const double known = static_cast<double>(parts * samples);
  const double variance =
      estimate.spread * estimate.spread * (1 + known / std::max(plain, 1.0)) + 2 / estimate.pixels;
  const double safe = kMargin * plain * quantile(std::min(std::sqrt(variance), 2.0), kNinetyFive);
  return safe >= kMost ? uint64_t{1} << 32 : rounded_up(static_cast<uint64_t>(std::ceil(safe)));
}

void PictureBlocks::add(const std::vector<Vec3d>& sums) {
  if (before_.empty()) before_.resize(sums.size());
  std::vector<Rgb>& block = blocks_.emplace_back();
  block.reserve(sums.size());
  const double share = 1 / static_cast<double>(size_);
  for (size_t i = 0; i < sums.size(); ++i)
    block.emplace_back(Vec3f((sums[i] - before_[i]) * share));
  before_ = sums;
  if (blocks_.size() < 8) return;
  for (size_t b = 0; b < 4; ++b) {
    for (size_t i = 0; i < sums.size(); ++i)
      blocks_[2 * b][i] = (blocks_[2 * b][i] + blocks_[2 * b + 1][i]) * 0.5f;
    if (b > 0) blocks_[b] = std::move(blocks_[2 * b]);
  }
  blocks_.resize(4);
  size_ *= 2;
}

}  // namespace tdpt
