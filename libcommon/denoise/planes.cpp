#include "libcommon/denoise/planes.h"

#include <algorithm>
#include <array>
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

}  // namespace tdpt::denoise
