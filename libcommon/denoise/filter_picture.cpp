#include "libcommon/denoise/filter_picture.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/counted.h"
#include "libcommon/base/error.h"
#include "libcommon/base/memory_limit.h"
#include "libcommon/base/number_words.h"
#include "libcommon/denoise/denoise.h"
#include "libcommon/denoise/oidn.h"

namespace tdpt::denoise {
namespace {

constexpr std::array kFeatureChannels{"albedo.R", "albedo.G", "albedo.B", "normal.X",
                                      "normal.Y", "normal.Z", "depth.Z"};
static_assert(kFeatureChannels.size() == kFeatures);
// Halves that differ from the picture by more than this share of its brightest value are not its.
constexpr double kNotItsHalves = 1e-3;

// What filtering needs at most besides the channels, for pictures of one block.
constexpr size_t kBytesOfPixel = 400;

// A reader of planes that checks every number.
class Buffers {
 public:
  Buffers(const ExrFile& file, const std::string& name) : file_(file), name_(name) {}

  Size size() const { return {file_.picture.width, file_.picture.height}; }

  Colour colour(const Picture& picture, const std::string& layer) const {
    Colour planes;
    for (size_t c = 0; c < 3; ++c) {
      planes[c].reserve(picture.pixels.size());
      for (const Rgb& p : picture.pixels) planes[c].push_back(p[static_cast<int>(c)]);
      check(planes[c], layer + "RGB"[c]);
      for (float& v : planes[c]) v = std::max(v, 0.0f);
    }
    return planes;
  }
  Colour half(const char* layer) const {
    const auto found = file_.layers.find(layer);
    if (found == file_.layers.end())
      throw InputError(name_, fmt::format("channel {}.R", layer),
                       "is missing; tdpt-render --aov halves,albedo,normal,depth makes what a "
                       "filter needs");
    return colour(found->second, std::string(layer) + ".");
  }
  /// Empty if it is missing.
  Plane channel(const std::string& channel) const {
    Plane plane;
    if (const auto found = file_.channels.find(channel); found != file_.channels.end()) {
      plane = found->second;
    } else if (const auto layer = file_.layers.find(channel.substr(0, channel.size() - 2));
               layer != file_.layers.end()) {
      const int c = channel.back() == 'R' ? 0 : channel.back() == 'G' ? 1 : 2;
      for (const Rgb& p : layer->second.pixels) plane.push_back(p[c]);
    }
    check(plane, channel);
    return plane;
  }

 private:
  void check(const Plane& plane, const std::string& channel) const {
    const auto bad =
        std::find_if(plane.begin(), plane.end(), [](float v) { return !std::isfinite(v); });
    if (bad == plane.end()) return;
    const auto pixel = bad - plane.begin();
    throw InputError(name_,
                     fmt::format("channel {} at pixel {} {}", channel, pixel % file_.picture.width,
                                 pixel / file_.picture.width),
                     "is no finite number");
  }

  const ExrFile& file_;
  const std::string& name_;
};

// Of the samples: picture = share A + (1 - share) B, by least squares.
double share_of(const Colour& picture, const Colour& a, const Colour& b, const std::string& name) {
  double products = 0, squares = 0, brightest = 0, off = 0;
  const auto each = [&](const auto& visit) {
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < picture[c].size(); ++i)
        visit(static_cast<double>(picture[c][i]), static_cast<double>(a[c][i]),
              static_cast<double>(b[c][i]));
  };
  each([&](double p, double x, double y) {
    products += (p - y) * (x - y);
    squares += (x - y) * (x - y);
    brightest = std::max({brightest, p, x, y});
  });
  const double share = squares > 0 ? products / squares : 0.5;
  each([&](double p, double x, double y) {
    off = std::max(off, std::abs(p - share * x - (1 - share) * y));
  });
  if (off > kNotItsHalves * brightest)
    throw InputError(name, "channel halfA.R", "is not half of this picture's samples");
  if (!(share > 1e-6 && share < 1 - 1e-6))
    throw InputError(name, "channel halfB.R",
                     "is empty: a filter needs two samples per pixel or more");
  return share;
}

// To [0,1]: nearer is larger, the mean depth is 1/2, nothing is 0.
void scale_depth(Plane& depth) {
  constexpr float kNothing = 1e9f;
  double sum = 0, count = 0;
  for (const float d : depth)
    if (d > 0 && d < kNothing) {
      sum += static_cast<double>(d);
      ++count;
    }
  const auto mean = static_cast<float>(count > 0 ? sum / count : 1);
  for (float& d : depth) d = d < kNothing ? mean / (mean + std::max(d, 0.0f)) : 0;
}

Features features_of(const Buffers& buffers, bool& any) {
  Features features;
  for (size_t f = 0; f < kFeatures; ++f) {
    features[f] = buffers.channel(kFeatureChannels[f]);
    any = any || !features[f].empty();
    features[f].resize(buffers.size().pixels());
    if (kFeatureChannels[f] == std::string_view("depth.Z")) scale_depth(features[f]);
    const float lowest = f < 3 ? 0.0f : -1.0f;
    for (float& v : features[f]) v = std::clamp(v, lowest, 1.0f);
  }
  return features;
}

// Replaces the pixels of `picture`, by the halves, and returns the errors.
Plane filter_by_regression(const Buffers& buffers, const Colour& noisy, const std::string& name,
                           Picture& picture, Filtered& filtered) {
  Input input{buffers.size(), buffers.half(kHalves[0]), buffers.half(kHalves[1]), 0.5,
              features_of(buffers, filtered.has_features)};
  input.share_a = share_of(noisy, input.a, input.b, name);
  filtered.denoiser = kKinds[0];
  filtered.share_a = input.share_a;
  Result result = denoise(std::move(input));
  for (size_t i = 0; i < picture.pixels.size(); ++i)
    picture.pixels[i] = {result.picture[0][i], result.picture[1][i], result.picture[2][i]};
  filtered.outliers = result.outliers;
  filtered.outlier_energy = result.outlier_energy;
  filtered.relmse = result.relmse;
  return std::move(result.error);
}

// Three channels; empty if one is missing.
std::vector<Rgb> triples(const Buffers& buffers, size_t first) {
  std::array<Plane, 3> planes;
  for (size_t c = 0; c < 3; ++c) planes[c] = buffers.channel(kFeatureChannels[first + c]);
  std::vector<Rgb> all;
  for (size_t i = 0; i < std::min({planes[0].size(), planes[1].size(), planes[2].size()}); ++i)
    all.emplace_back(planes[0][i], planes[1][i], planes[2][i]);
  return all;
}

void filter_by_oidn(const Buffers& buffers, Picture& picture, Filtered& filtered) {
  OpenImageDenoise oidn;
  filtered.denoiser = fmt::format("{} {}", kKinds[1], oidn.version());
  const std::vector<Rgb> albedo = triples(buffers, 0);
  filtered.has_features = !albedo.empty();
  picture.pixels = oidn.filter(picture, albedo, triples(buffers, 3));
}

}  // namespace

ExrFile parse_with_channels(std::string_view bytes, const std::string& name) {
  ExrFile file = parse_exr(bytes, name);
  const auto pixels = file.picture.pixels.size();
  const std::vector<std::string> names = exr_channels(bytes, name);
  expect_memory(name, "",
                fmt::format("{} channels of {} pixels, to be filtered,", names.size(), pixels),
                (names.size() * sizeof(float) + kBytesOfPixel) * pixels);
  std::vector<WordChannel> words;
  const auto read = [&](const std::string& channel, std::vector<float>& values) {
    values.resize(pixels);
    words.push_back({channel, reinterpret_cast<unsigned char*>(values.data()), sizeof(float),
                     WordChannel::real});
  };
  for (const std::string& channel : names) {
    const size_t dot = channel.rfind('.');
    const bool in_layer =
        dot != std::string::npos && file.layers.contains(channel.substr(0, dot)) &&
        (channel.ends_with(".R") || channel.ends_with(".G") || channel.ends_with(".B"));
    if (in_layer || channel == "R" || channel == "G" || channel == "B") continue;
    read(channel, channel == "A" ? file.picture.alpha : file.channels[channel]);
  }
  if (!words.empty()) parse_exr_words(bytes, name, file.picture.width, file.picture.height, words);
  return file;
}

Kind kind_of(const std::string& name) {
  return name == kKinds[1] ? Kind::oidn : Kind::regression;
}

std::string sentence_of(const Filtered& filtered) {
  if (filtered.denoiser.starts_with(kKinds[1]))
    return fmt::format("filtered by Open Image Denoise{}, no longer unbiased",
                       filtered.denoiser.substr(std::string_view(kKinds[1]).size()));
  std::string words = "filtered, no longer unbiased";
  if (filtered.relmse > 0) words += ", relMSE about " + number_words(filtered.relmse, 2);
  if (filtered.outliers > 0)
    words += fmt::format("; the light of {} ({} % of all) was spread",
                         counted(filtered.outliers, "outlier"),
                         number_words(100 * filtered.outlier_energy, 2));
  return words;
}

Filtered filter_picture(ExrFile& file, const std::string& name, Kind kind) {
  const Buffers buffers(file, name);
  const auto before = file.layers.find(kNoisyLayer);
  const bool again = before != file.layers.end();
  Picture noisy = again ? before->second : file.picture;
  const Colour planes = buffers.colour(noisy, again ? "noisy." : "");
  Picture picture = noisy;
  Filtered filtered;
  file.channels.erase(kErrorChannel);
  if (kind == Kind::oidn)
    filter_by_oidn(buffers, picture, filtered);
  else
    file.channels[kErrorChannel] = filter_by_regression(buffers, planes, name, picture, filtered);
  noisy.alpha.clear();
  file.layers[kNoisyLayer] = std::move(noisy);
  file.picture.pixels = std::move(picture.pixels);
  file.attributes[denoiser_attribute] = filtered.denoiser;
  return filtered;
}

}  // namespace tdpt::denoise
