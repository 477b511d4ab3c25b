#include "libcommon/denoise/reproject.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include <oneapi/tbb/parallel_for.h>

namespace tdpt::denoise {
namespace {

// Depths that differ by less than this share are of the same surface.
constexpr double kSameDepth = 0.03;
// Of the weights of four pixels, how much those that show a place must have.
constexpr double kLeastWeight = 0.2;
// How many times as bright as another one of them may be, unless its share is that of rounding.
constexpr float kAlike = 4, kNoShare = 1e-6f;

// Four pixels, and the share of each in what is seen between them.
struct Taps {
  std::array<size_t, 4> pixel{};
  std::array<float, 4> share{};
  bool any = false;
};

size_t index_of(const View& view, int x, int y) {
  return static_cast<size_t>(y) * static_cast<size_t>(view.film.width()) + static_cast<size_t>(x);
}

// Linear interpolation at a raster place among the pixels about it that `shows` accepts by their
// depth.
template <class Shows>
Taps taps_at(const View& view, double x, double y, const Shows& shows) {
  Taps taps;
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
  const double across = x - 0.5 - left, down = y - 0.5 - top;
  std::array<double, 4> weights{};
  for (size_t k = 0; k < 4; ++k) {
    const bool right = k % 2, below = k / 2;
    const int column = std::clamp(static_cast<int>(left) + right, 0, view.film.width() - 1);
    const int row = std::clamp(static_cast<int>(top) + below, 0, view.film.height() - 1);
    taps.pixel[k] = index_of(view, column, row);
    if (shows(view.depth[taps.pixel[k]]))
      weights[k] = (right ? across : 1 - across) * (below ? down : 1 - down);
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  taps.any = sum > kLeastWeight;
  for (size_t k = 0; taps.any && k < 4; ++k) taps.share[k] = static_cast<float>(weights[k] / sum);
  return taps;
}

// The pixels of `from` that show what `to` shows in the middle of pixel (x, y).
Taps pixels_that_show(const View& from, const View& to, int x, int y) {
  const float depth = to.depth[index_of(to, x, y)];
  if (!(depth > 0)) return {};
  const Vec3d w = to.film.direction(x + 0.5, y + 0.5);
  double u, v;
  if (!(depth < kNothing)) {
    if (!from.film.raster(w, u, v)) return {};
    return taps_at(from, u, v, [](float found) { return !(found < kNothing); });
  }
  const double along = static_cast<double>(depth) / dot(w, to.film.forward());
  const Vec3d away = to.film.position() + w * along - from.film.position();
  const double expected = dot(away, from.film.forward());
  if (!(length(away) > 0) || !from.film.raster(normalize(away), u, v)) return {};
  return taps_at(from, u, v, [expected](float found) {
    return std::abs(static_cast<double>(found) - expected) < kSameDepth * expected;
  });
}

// Between what each half says, a pixel is about so bright, whatever its noise.
struct Brightness {
  Plane least, most;
};

Brightness brightness_of(const Shot& shot, Size size) {
  const auto of_half = [&](const Colour& half) {
    Plane all(size.pixels());
    for (size_t i = 0; i < all.size(); ++i) all[i] = half[0][i] + half[1][i] + half[2][i];
    return medians(all, size);
  };
  Brightness all{of_half(shot.a), of_half(shot.b)};
  for (size_t i = 0; i < size.pixels(); ++i)
    std::tie(all.least[i], all.most[i]) = std::minmax({all.least[i], all.most[i]});
  return all;
}

// Whether the taps may be as bright as each other, roughly: a mixture of a lamp and of what is
// beside it is neither, and would be a halo of the lamp.
bool alike(const Taps& taps, const Brightness& brightness) {
  float dim = std::numeric_limits<float>::max(), bright = 0;
  for (size_t k = 0; k < 4; ++k) {
    if (taps.share[k] < kNoShare) continue;
    dim = std::min(dim, brightness.most[taps.pixel[k]]);
    bright = std::max(bright, brightness.least[taps.pixel[k]]);
  }
  return bright <= kAlike * dim;
}

}  // namespace

Neighbour reproject(const Shot& there, const View& from, const Shot& here, const View& to) {
  Neighbour all{here, Plane(to.depth.size())};
  all.shot.share_a = there.share_a;
  const Brightness brightness = brightness_of(there, {from.film.width(), from.film.height()});
  tbb::parallel_for(0, to.film.height(), [&](int y) {
    for (int x = 0; x < to.film.width(); ++x) {
      const Taps taps = pixels_that_show(from, to, x, y);
      if (!taps.any || !alike(taps, brightness)) continue;
      const auto seen = [&](const Plane& plane) {
        float value = 0;
        for (size_t k = 0; k < 4; ++k) value += taps.share[k] * plane[taps.pixel[k]];
        return value;
      };
      const size_t i = index_of(to, x, y);
      all.present[i] = 1;
      for (size_t c = 0; c < 3; ++c) {
        all.shot.a[c][i] = seen(there.a[c]);
        all.shot.b[c][i] = seen(there.b[c]);
      }
      // The depth, the last feature, is that from here.
      for (size_t f = 0; f + 1 < kFeatures; ++f) all.shot.features[f][i] = seen(there.features[f]);
    }
  });
  return all;
}

}  // namespace tdpt::denoise
