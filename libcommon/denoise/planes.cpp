#include "libcommon/denoise/planes.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>

namespace tdpt::denoise {

namespace {

// One dimension of the filter.
class Bell {
 public:
  explicit Bell(double deviation) : reach_(static_cast<int>(std::ceil(3 * deviation))) {
    for (int i = 0; i <= reach_; ++i)
      weights_.push_back(static_cast<float>(std::exp(-i * i / (2 * deviation * deviation))));
  }
  float operator()(int d) const { return weights_[static_cast<size_t>(std::abs(d))]; }
  int first(int at) const { return std::max(0, at - reach_); }
  int last(int at, int count) const { return std::min(count - 1, at + reach_); }
  /// At place `at` of `count`; the middle weight is 1.
  float sum(int at, int count) const {
    float all = 0;
    for (int k = first(at); k <= last(at, count); ++k) all += (*this)(k - at);
    return all;
  }

 private:
  int reach_;
  std::vector<float> weights_;
};

}  // namespace

Plane smooth(const Plane& plane, Size size, double deviation) {
  const Bell bell(deviation);
  Plane rows(plane.size()), all(plane.size());
  tbb::parallel_for(0, size.height, [&](int y) {
    const float* from = plane.data() + size.index(0, y);
    float* to = rows.data() + size.index(0, y);
    for (int x = 0; x < size.width; ++x) {
      float sum = 0;
      for (int k = bell.first(x); k <= bell.last(x, size.width); ++k) sum += bell(k - x) * from[k];
      to[x] = sum / bell.sum(x, size.width);
    }
  });
  tbb::parallel_for(0, size.height, [&](int y) {
    float* to = all.data() + size.index(0, y);
    const auto width = static_cast<size_t>(size.width);
    for (int k = bell.first(y); k <= bell.last(y, size.height); ++k) {
      const float* from = rows.data() + size.index(0, k);
      const float w = bell(k - y);
      for (size_t x = 0; x < width; ++x) to[x] += w * from[x];
    }
    const float per = 1 / bell.sum(y, size.height);
    for (size_t x = 0; x < width; ++x) to[x] *= per;
  });
  return all;
}

Plane smooth_others(const Plane& plane, Size size, double deviation) {
  const Bell bell(deviation);
  Plane all = smooth(plane, size, deviation);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const size_t i = size.index(x, y);
      const float weights = bell.sum(y, size.height) * bell.sum(x, size.width);
      if (weights > 1) all[i] = (all[i] * weights - plane[i]) / (weights - 1);
    }
  return all;
}

Plane halved(const Plane& plane, Size size) {
  const Size half = half_of(size);
  Plane all;
  all.reserve(half.pixels());
  const auto at = [&](int x, int y) {
    return plane[size.index(std::min(x, size.width - 1), std::min(y, size.height - 1))];
  };
  for (int y = 0; y < size.height; y += 2)
    for (int x = 0; x < size.width; x += 2)
      all.push_back(0.25f * (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)));
  return all;
}

Plane doubled(const Plane& plane, Size size) {
  const Size half = half_of(size);
  Plane all;
  all.reserve(size.pixels());
  // The nearest of the other pixels, a quarter of a pixel beyond the own one's centre.
  const auto beside = [](int k, int count) {
    return std::clamp(k / 2 + (k % 2 ? 1 : -1), 0, count - 1);
  };
  for (int y = 0; y < size.height; ++y) {
    const float* near = plane.data() + half.index(0, y / 2);
    const float* far = plane.data() + half.index(0, beside(y, half.height));
    for (int x = 0; x < size.width; ++x) {
      const int own = x / 2, other = beside(x, half.width);
      all.push_back(0.0625f * (9 * near[own] + 3 * (near[other] + far[own]) + far[other]));
    }
  }
  return all;
}

Plane medians(const Plane& plane, Size size) {
  Plane all(plane.size());
  tbb::parallel_for(0, size.height, [&](int y) {
    for (int x = 0; x < size.width; ++x) {
      std::array<float, 9> around{};
      auto end = around.begin();
      for (int v = std::max(0, y - 1); v <= std::min(size.height - 1, y + 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(size.width - 1, x + 1); ++u)
          *end++ = plane[size.index(u, v)];
      const auto middle = around.begin() + (end - around.begin()) / 2;
      std::nth_element(around.begin(), middle, end);
      all[size.index(x, y)] = *middle;
    }
  });
  return all;
}

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
      const float value = plane[size.index(u, v)];
      found.first = std::max(found.first, value);
      if (u == x && v == y) continue;
      found.second_other = std::max(found.second_other, std::min(other, value));
      other = std::max(other, value);
    }
  return found;
}

// One half, and the number of pixels that were darkened.
Colour without_outliers(Size size, const Colour& half, const Colour& other,
                        std::atomic<size_t>& pixels) {
  const Plane own = luminances(half), others = luminances(other);
  Colour rest = half;
  tbb::parallel_for(0, size.height, [&](int y) {
    for (int x = 0; x < size.width; ++x) {
      const size_t i = size.index(x, y);
      if (!(own[i] > 0)) continue;
      const float most = kTooBright * std::max(brightest(own, size, x, y, 2).second_other,
                                               brightest(others, size, x, y, 1).first);
      if (own[i] <= most) continue;
      ++pixels;
      for (Plane& plane : rest) plane[i] *= most / own[i];
    }
  });
  return rest;
}

}  // namespace

size_t cut_outliers(Size size, Colour& a, Colour& b) {
  std::atomic<size_t> pixels{0};
  Colour rest = without_outliers(size, a, b, pixels);
  b = without_outliers(size, b, a, pixels);
  a = std::move(rest);
  return pixels;
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
    const float difference = of_a[i] - of_b[i];
    noise[i] = share_a * (1 - share_a) * difference * difference;
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
