#include "libcommon/denoise/outliers.h"

#include <algorithm>
#include <atomic>

#include <oneapi/tbb/parallel_for.h>

namespace tdpt::denoise {
namespace {

constexpr float kTooBright = 2;
constexpr double kSpread = 20;  // deviation of the filter that spreads light [pixels]
// What is missing must be so many standard errors above its noise.
constexpr float kCertain = 1.5f;

Plane luminances(const Colour& colour) {
  Plane all(colour[0].size());
  for (size_t i = 0; i < all.size(); ++i)
    all[i] = 0.2126f * colour[0][i] + 0.7152f * colour[1][i] + 0.0722f * colour[2][i];
  return all;
}

// The brightest within `reach` pixels of one, and the second brightest other than the pixel itself.
struct Brightest {
  float first = 0, second_other = 0;
};
Brightest brightest(const Plane& plane, Size size, int x, int y, int reach) {
  Brightest found;
  float other = 0;
  for (int v = std::max(0, y - reach); v <= std::min(size.height - 1, y + reach); ++v)
    for (int u = std::max(0, x - reach); u <= std::min(size.width - 1, x + reach); ++u) {
      const float value =
          plane[static_cast<size_t>(v) * static_cast<size_t>(size.width) + static_cast<size_t>(u)];
      found.first = std::max(found.first, value);
      if (u == x && v == y) continue;
      found.second_other = std::max(found.second_other, std::min(other, value));
      other = std::max(other, value);
    }
  return found;
}

}  // namespace

Outliers cut_outliers(Size size, const Colour& half, const Colour& other) {
  const Plane own = luminances(half), others = luminances(other);
  Outliers outliers;
  outliers.rest = half;
  std::atomic<size_t> pixels{0};
  tbb::parallel_for(0, size.height, [&](int y) {
    for (int x = 0; x < size.width; ++x) {
      const size_t i =
          static_cast<size_t>(y) * static_cast<size_t>(size.width) + static_cast<size_t>(x);
      if (!(own[i] > 0)) continue;
      const float most = kTooBright * std::max(brightest(own, size, x, y, 2).second_other,
                                               brightest(others, size, x, y, 1).first);
      if (own[i] <= most) continue;
      ++pixels;
      for (Plane& plane : outliers.rest) plane[i] *= most / own[i];
    }
  });
  outliers.pixels = pixels;
  return outliers;
}

// r = smoothed(half - picture) / smoothed(picture) of both halves, v the variance of their mean:
// the picture is multiplied by 1 + r - certain^2 v / r, where that is more certain than chance.
void restore_light(Size size, const Colour& a, const Colour& b, float share_a, Colour& picture) {
  const Plane own = luminances(picture), around = smooth(own, size, kSpread);
  const auto missing = [&](const Colour& half) {
    Plane all = luminances(half);
    for (size_t i = 0; i < all.size(); ++i) all[i] -= own[i];
    all = smooth(all, size, kSpread);
    for (size_t i = 0; i < all.size(); ++i) all[i] = around[i] > 0 ? all[i] / around[i] : 0;
    return all;
  };
  const Plane of_a = missing(a), of_b = missing(b);
  Plane noise(own.size());
  for (size_t i = 0; i < noise.size(); ++i) {
    const float apart = of_a[i] - of_b[i];
    noise[i] = share_a * (1 - share_a) * apart * apart;
  }
  const Plane usual = smooth(noise, size, kSpread);
  for (size_t i = 0; i < noise.size(); ++i) {
    const float r = share_a * of_a[i] + (1 - share_a) * of_b[i];
    const float v = kCertain * kCertain * std::max(noise[i], usual[i]);
    if (!(r * r > v)) continue;
    const float factor = std::max(1 + r - v / r, 0.0f);
    for (Plane& plane : picture) plane[i] *= factor;
  }
}

}  // namespace tdpt::denoise
