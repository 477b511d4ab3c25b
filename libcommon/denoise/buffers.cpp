#include "libcommon/denoise/buffers.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

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

Shot Buffers::shot(bool& any) const {
  Shot shot{half(kHalves[0]), half(kHalves[1]), 0.5, features(any)};
  shot.share_a = share_of(light(), shot.a, shot.b);
  return shot;
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
  const auto told = file_.attributes.find("camera");
  const auto viewpoint =
      told != file_.attributes.end() ? parse_viewpoint(told->second) : std::nullopt;
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

// Of the samples: picture = share A + (1 - share) B, by least squares of relative errors.
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

}  // namespace tdpt::denoise
