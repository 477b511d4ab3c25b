#include "libcommon/denoise/buffers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "libcommon/base/error.h"
#include "libcommon/formats/viewpoint.h"

namespace tdpt::denoise {

namespace {

// Halves are not those of the picture if they differ from it by more than this share of a pixel,
// as half floats do not, and of the brightest one.
constexpr double kNotItsHalves = 4e-3, kNothingOfIt = 1e-6;

// To [0,1]: nearer is larger, the mean depth is 1/2, nothing is 0.
void scale_depth(Plane& depth) {
  double sum = 0, count = 0;
  for (const float d : depth)
    if (d > 0 && d < kNothing) {
      sum += static_cast<double>(d);
      ++count;
    }
  const auto mean = static_cast<float>(count > 0 ? sum / count : 1);
  for (float& d : depth) d = d < kNothing ? mean / (mean + std::max(d, 0.0f)) : 0;
}

}  // namespace

const Picture& Buffers::noisy() const {
  const auto layer = file_.layers.find(kNoisyLayer);
  return layer != file_.layers.end() ? layer->second : file_.picture;
}

NoisyHalves Buffers::halves(bool& any) const {
  NoisyHalves halves{half(kHalves[0]), half(kHalves[1]), 0.5, features(any)};
  halves.share_a = share_of(light(), halves.a, halves.b);
  return halves;
}

Colour Buffers::light() const {
  const Picture& picture = noisy();
  return colour(picture, &picture == &file_.picture ? "" : "noisy.");
}

Plane Buffers::channel(const std::string& channel) const {
  Plane plane;
  if (const auto found = file_.channels.find(channel); found != file_.channels.end()) {
    plane = found->second;
  } else if (const auto layer = file_.layers.find(channel.substr(0, channel.size() - 2));
             layer != file_.layers.end()) {
    const size_t c = std::string_view("RGB").find(channel.back());
    if (c != std::string_view::npos)
      for (const Rgb& p : layer->second.pixels) plane.push_back(p[static_cast<int>(c)]);
  }
  check(plane, channel);
  return plane;
}

View Buffers::view() const {
  const auto camera = file_.attributes.find("camera");
  const auto viewpoint =
      camera != file_.attributes.end() ? parse_viewpoint(camera->second) : std::nullopt;
  if (!viewpoint)
    throw InputError(name_, "attribute camera",
                     "is missing or malformed: frames are aligned by camera and depth");
  Plane depth = channel("depth.Z");
  if (depth.empty())
    throw InputError(name_, "channel depth.Z",
                     "is missing: frames are aligned by camera and depth");
  return {FilmPlane(camera_of(Frame{}, *viewpoint), size().width, size().height), std::move(depth)};
}

Colour Buffers::colour(const Picture& picture, const std::string& layer) const {
  Colour planes;
  for (size_t c = 0; c < 3; ++c) {
    planes[c].reserve(picture.pixels.size());
    for (const Rgb& p : picture.pixels) planes[c].push_back(p[static_cast<int>(c)]);
    check(planes[c], layer + "RGB"[c]);
  }
  const auto largest = [](const Rgb& p) { return static_cast<double>(max_component(p)); };
  double brightest = 0;
  for (const Rgb& p : picture.pixels) brightest = std::max(brightest, largest(p));
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < planes[c].size(); ++i) {
      float& v = planes[c][i];
      const double rounded = kNotItsHalves * largest(picture.pixels[i]) + kNothingOfIt * brightest;
      if (static_cast<double>(v) < -std::max(rounded, 0.0))
        refuse(layer + "RGB"[c], i, fmt::format("is {}, expected light from 0", v));
      v = std::max(v, 0.0f);
    }
  return planes;
}

Colour Buffers::half(const char* layer) const {
  const auto found = file_.layers.find(layer);
  if (found == file_.layers.end())
    throw InputError(name_, fmt::format("channel {}.R", layer),
                     "is missing; tdpt-render --aov halves,albedo,normal,depth makes what a "
                     "filter needs");
  return colour(found->second, std::string(layer) + ".");
}

Features Buffers::features(bool& any) const {
  Features features;
  for (size_t f = 0; f < kFeatures; ++f) {
    features[f] = channel(kFeatureChannels[f]);
    any = any || !features[f].empty();
    features[f].resize(size().pixels());
    if (kFeatureChannels[f] == std::string_view("depth.Z")) scale_depth(features[f]);
    const float lowest = f < 3 ? 0.0f : -1.0f;
    for (float& v : features[f]) v = std::clamp(v, lowest, 1.0f);
  }
  return features;
}

// The share of the samples: picture = share A + (1 - share) B, by least squares of relative errors.
double Buffers::share_of(const Colour& picture, const Colour& a, const Colour& b) const {
  double products = 0, squares = 0, brightest = 0;
  const auto each = [&](const auto& visit) {
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < picture[c].size(); ++i)
        visit(static_cast<double>(picture[c][i]), static_cast<double>(a[c][i]),
              static_cast<double>(b[c][i]));
  };
  each([&](double p, double x, double y) {
    const double bright = std::max({p, x, y});
    brightest = std::max(brightest, bright);
    if (!(bright > 0)) return;
    products += (p - y) / bright * ((x - y) / bright);
    squares += (x - y) / bright * ((x - y) / bright);
  });
  const double share = squares > 0 ? products / squares : 0.5;
  size_t visited = 0;
  each([&](double p, double x, double y) {
    const double most = kNotItsHalves * std::max({p, x, y}) + kNothingOfIt * brightest;
    if (!(std::abs(p - share * x - (1 - share) * y) <= most))
      refuse(fmt::format("{}.{}", kHalves[0], "RGB"[visited / size().pixels()]),
             visited % size().pixels(),
             "is not half of this picture's samples, or lost digits in compression");
    ++visited;
  });
  if (!(share > 1e-6 && share < 1 - 1e-6))
    throw InputError(name_, "channel halfB.R",
                     "is empty: a filter needs two samples per pixel or more");
  return share;
}

void Buffers::check(const Plane& plane, const std::string& channel) const {
  const auto bad =
      std::find_if(plane.begin(), plane.end(), [](float v) { return !std::isfinite(v); });
  if (bad != plane.end())
    refuse(channel, static_cast<size_t>(bad - plane.begin()), "is no finite number");
}

void Buffers::refuse(const std::string& channel, size_t pixel, const std::string& words) const {
  const auto width = static_cast<size_t>(file_.picture.width);
  throw InputError(name_,
                   fmt::format("channel {} at pixel {} {}", channel, pixel % width, pixel / width),
                   words);
}

namespace {

// Depths that differ by less than this share are of the same surface.
constexpr double kSameDepth = 0.03;
// The least share of the weights of four pixels that those which show a place must have.
constexpr double kLeastWeight = 0.2;
// How many times as bright as another one of them may be, unless its share is that of rounding.
constexpr float kAlike = 4, kNoShare = 1e-6f;

// Four pixels, and the share of each in what is seen between them.
struct Taps {
  std::array<size_t, 4> pixel{};
  std::array<float, 4> share{};
  bool any = false;
};

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
    taps.pixel[k] = view.size().index(column, row);
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
  const float depth = to.depth[to.size().index(x, y)];
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

Brightness brightness_of(const NoisyHalves& halves, Size size) {
  const auto of_half = [&](const Colour& half) {
    Plane all(size.pixels());
    for (size_t i = 0; i < all.size(); ++i) all[i] = half[0][i] + half[1][i] + half[2][i];
    return medians(all, size);
  };
  Brightness all{of_half(halves.a), of_half(halves.b)};
  for (size_t i = 0; i < size.pixels(); ++i)
    std::tie(all.least[i], all.most[i]) = std::minmax({all.least[i], all.most[i]});
  return all;
}

// Whether the taps may be as bright as each other, roughly: a mixture of a lamp and of what is
// beside it is neither, and would be a halo of the lamp.
bool has_one_brightness(const Taps& taps, const Brightness& brightness) {
  float dim = std::numeric_limits<float>::max(), bright = 0;
  for (size_t k = 0; k < 4; ++k) {
    if (taps.share[k] < kNoShare) continue;
    dim = std::min(dim, brightness.most[taps.pixel[k]]);
    bright = std::max(bright, brightness.least[taps.pixel[k]]);
  }
  return bright <= kAlike * dim;
}

}  // namespace

Neighbour reproject(const NoisyHalves& there, const View& from, const NoisyHalves& here,
                    const View& to) {
  Neighbour all{here, Plane(to.depth.size())};
  all.halves.share_a = there.share_a;
  const Brightness brightness = brightness_of(there, from.size());
  tbb::parallel_for(0, to.film.height(), [&](int y) {
    for (int x = 0; x < to.film.width(); ++x) {
      const Taps taps = pixels_that_show(from, to, x, y);
      if (!taps.any || !has_one_brightness(taps, brightness)) continue;
      const auto seen = [&](const Plane& plane) {
        float value = 0;
        for (size_t k = 0; k < 4; ++k) value += taps.share[k] * plane[taps.pixel[k]];
        return value;
      };
      const size_t i = to.size().index(x, y);
      all.present[i] = 1;
      for (size_t c = 0; c < 3; ++c) {
        all.halves.a[c][i] = seen(there.a[c]);
        all.halves.b[c][i] = seen(there.b[c]);
      }
      // The depth, the last feature, is that from here.
      for (size_t f = 0; f + 1 < kFeatures; ++f)
        all.halves.features[f][i] = seen(there.features[f]);
    }
  });
  return all;
}

}  // namespace tdpt::denoise
