#include "libcommon/denoise/planes.h"

#include <algorithm>
#include <array>
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

// The sums of weights that smooth() divides by: less at the borders.
Plane weights_of_smoothing(Size size, double deviation) {
  const Bell bell(deviation);
  Plane columns;
  for (int x = 0; x < size.width; ++x) columns.push_back(bell.sum(x, size.width));
  Plane all;
  all.reserve(size.pixels());
  for (int y = 0; y < size.height; ++y) {
    const float row = bell.sum(y, size.height);
    for (const float column : columns) all.push_back(row * column);
  }
  return all;
}

}  // namespace

Plane smooth(const Plane& plane, Size size, double deviation) {
  const Bell bell(deviation);
  const auto width = static_cast<size_t>(size.width);
  Plane rows(plane.size()), all(plane.size());
  tbb::parallel_for(0, size.height, [&](int y) {
    const float* from = plane.data() + static_cast<size_t>(y) * width;
    float* to = rows.data() + static_cast<size_t>(y) * width;
    for (int x = 0; x < size.width; ++x) {
      float sum = 0;
      for (int k = bell.first(x); k <= bell.last(x, size.width); ++k) sum += bell(k - x) * from[k];
      to[x] = sum / bell.sum(x, size.width);
    }
  });
  tbb::parallel_for(0, size.height, [&](int y) {
    float* to = all.data() + static_cast<size_t>(y) * width;
    for (int k = bell.first(y); k <= bell.last(y, size.height); ++k) {
      const float* from = rows.data() + static_cast<size_t>(k) * width;
      const float w = bell(k - y);
      for (size_t x = 0; x < width; ++x) to[x] += w * from[x];
    }
    const float per = 1 / bell.sum(y, size.height);
    for (size_t x = 0; x < width; ++x) to[x] *= per;
  });
  return all;
}

Plane smooth_others(const Plane& plane, Size size, double deviation) {
  Plane all = smooth(plane, size, deviation);
  const Plane weights = weights_of_smoothing(size, deviation);
  for (size_t i = 0; i < all.size(); ++i)
    if (weights[i] > 1) all[i] = (all[i] * weights[i] - plane[i]) / (weights[i] - 1);
  return all;
}

Plane halved(const Plane& plane, Size size) {
  const Size half = half_of(size);
  Plane all;
  all.reserve(half.pixels());
  const auto at = [&](int x, int y) {
    return plane[static_cast<size_t>(std::min(y, size.height - 1)) *
                     static_cast<size_t>(size.width) +
                 static_cast<size_t>(std::min(x, size.width - 1))];
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
    const float* near = plane.data() + static_cast<size_t>(y / 2) * static_cast<size_t>(half.width);
    const float* far = plane.data() + static_cast<size_t>(beside(y, half.height)) *
                                          static_cast<size_t>(half.width);
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
          *end++ = plane[static_cast<size_t>(v) * static_cast<size_t>(size.width) +
                         static_cast<size_t>(u)];
      const auto middle = around.begin() + (end - around.begin()) / 2;
      std::nth_element(around.begin(), middle, end);
      all[static_cast<size_t>(y) * static_cast<size_t>(size.width) + static_cast<size_t>(x)] =
          *middle;
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
