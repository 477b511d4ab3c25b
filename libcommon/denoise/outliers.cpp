#include "libcommon/denoise/outliers.h"

#include <algorithm>
#include <atomic>

#include <oneapi/tbb/parallel_for.h>

namespace tdpt::denoise {
namespace {

constexpr float kTooBright = 2;
constexpr double kSpread = 10;  // deviation of the filter that spreads energy [pixels]

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

// What is missing at p goes to q by g(p - q) picture(q) / (sum of these over q), g a Gaussian.
void restore_energy(Size size, const Colour& noisy, Colour& picture) {
  const Plane weights = weights_of_smoothing(size, kSpread);
  for (size_t c = 0; c < 3; ++c) {
    const Plane around = smooth(picture[c], size, kSpread);
    // Where all around is black, it is spread evenly.
    Plane share(around.size()), even(around.size());
    for (size_t i = 0; i < share.size(); ++i) {
      const float missing = (noisy[c][i] - picture[c][i]) / weights[i];
      (around[i] > 0 ? share : even)[i] = around[i] > 0 ? missing / around[i] : missing;
    }
    share = smooth(share, size, kSpread);
    even = smooth(even, size, kSpread);
    for (size_t i = 0; i < share.size(); ++i) {
      const float factor = 1 + weights[i] * share[i];
      picture[c][i] = std::max(picture[c][i] * factor + weights[i] * even[i], 0.0f);
    }
  }
}

}  // namespace tdpt::denoise
