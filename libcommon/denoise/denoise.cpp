#include "libcommon/denoise/denoise.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "libcommon/denoise/outliers.h"

namespace tdpt::denoise {
namespace {

constexpr std::array kPilotBandwidth{0.5f};
constexpr std::array kBandwidths{0.25f, 0.5f, 1.0f};
constexpr int kPilotPatch = 3, kPatch = 1;
// The light is filtered after division by the albedo plus this.
constexpr float kAlbedoOffset = 0.5f;
// Deviations of filters [pixels]: of variances, of errors, of what is chosen, of brightness, of
// the error that is told.
constexpr double kVarianceSmoothing = 1.5, kErrorSmoothing = 3, kChoiceSmoothing = 2,
                 kBrightnessSmoothing = 2, kMapSmoothing = 5;
// The noisy pixel counts only as far as the filter's error is so many standard errors above 0.
constexpr double kCertain = 3;
// It then counts as if the error were so many times as large: errors lie on few of the pixels over
// which they are averaged.
constexpr double kFew = 3;
// How many times as bright as itself a pixel's neighbours count, and what is added to brightness,
// of the mean radiance.
constexpr float kBrighter = 2, kDim = 0.01f;
constexpr double kDark = 0.01;       // as in relMSE
constexpr float kBrightest = 1e12f;  // over the mean of this picture; only other frames have it
constexpr double kUntold = 1.5;      // see the header

struct Halves {
  Colour a, b;
};

Colour mean(const Halves& h, float share_a) {
  Colour all;
  for (size_t c = 0; c < 3; ++c) {
    all[c].resize(h.a[c].size());
    for (size_t i = 0; i < all[c].size(); ++i)
      all[c][i] = share_a * h.a[c][i] + (1 - share_a) * h.b[c][i];
  }
  return all;
}

// Squared differences, smoothed, times a factor. What a pixel has of brighter ones is limited as if
// they were kBrighter times as bright as it: beside a lamp there is no noise of the lamp's size.
Colour differences(Size size, const Halves& h, float factor) {
  Colour all;
  for (size_t c = 0; c < 3; ++c) {
    Plane bright(size.pixels()), squares(size.pixels()), relative(size.pixels());
    for (size_t i = 0; i < bright.size(); ++i) bright[i] = 0.5f * (h.a[c][i] + h.b[c][i]);
    bright = medians(bright, size);
    for (float& b : bright) b = (b + kDim) * (b + kDim);
    for (size_t i = 0; i < squares.size(); ++i) {
      const float d = h.a[c][i] - h.b[c][i];
      squares[i] = factor * (d * d);
      relative[i] = squares[i] / bright[i];
    }
    all[c] = smooth(squares, size, kVarianceSmoothing);
    relative = smooth(relative, size, kVarianceSmoothing);
    for (size_t i = 0; i < squares.size(); ++i)
      all[c][i] = std::min(all[c][i], kBrighter * kBrighter * bright[i] * relative[i]);
  }
  return all;
}

double mean_of(const Plane& plane) {
  double sum = 0;
  for (const float v : plane) sum += static_cast<double>(v);
  return sum / static_cast<double>(plane.size());
}
double mean_of(const Colour& colour) {
  return (mean_of(colour[0]) + mean_of(colour[1]) + mean_of(colour[2])) / 3;
}

// Division by the albedo leaves the light, which is smoother. Multiplication restores it.
enum class Albedo : uint8_t { divide, multiply };
void by_albedo(Colour& colour, Albedo how, const Features& features) {
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < colour[c].size(); ++i) {
      const float factor = features[c][i] + kAlbedoOffset;
      colour[c][i] = how == Albedo::divide ? colour[c][i] / factor : colour[c][i] * factor;
    }
}

// The light of a frame's halves, and crude estimates of them.
struct Light {
  Halves noisy;
  Colour variance_a, variance_b;
  Halves pilot{};
  Colour rest{};  ///< variance of the pilot
};

Light light_of(Size size, const Shot& shot) {
  const auto share_a = static_cast<float>(shot.share_a);
  Halves noisy{shot.a, shot.b};
  by_albedo(noisy.a, Albedo::divide, shot.features);
  by_albedo(noisy.b, Albedo::divide, shot.features);
  Colour variance_a = differences(size, noisy, 1 - share_a);
  Colour variance_b = differences(size, noisy, share_a);
  return {std::move(noisy), std::move(variance_a), std::move(variance_b)};
}

class Filter {
 public:
  Filter(Input in, double light)
      : in_(std::move(in)),
        size_(in_.size),
        share_a_(static_cast<float>(in_.shot.share_a)),
        light_(light),
        noise_{in_.shot.a, in_.shot.b} {}

  /// The picture, and about its squared relative error around each pixel.
  struct Estimate {
    Colour picture;
    Plane error;
  };
  Estimate run() {
    weigh_errors();
    make_candidates();
    Plane error;
    Halves best = choose(error);
    mix_with_noisy(best);
    return {mean(best, share_a_), smooth(error, size_, kMapSmoothing)};
  }

 private:
  // Squared errors are relative to the brightness around, as in relMSE.
  void weigh_errors() {
    per_ = mean(noise_, share_a_);
    for (Plane& plane : per_) {
      plane = smooth(plane, size_, kBrightnessSmoothing);
      for (float& v : plane) {
        const auto bright = static_cast<double>(v);
        v = static_cast<float>(1 / (3 * (bright * bright + kDark * light_ * light_)));
      }
    }
  }

  const Shot& shot(size_t k) const { return k == 0 ? in_.shot : in_.neighbours[k - 1].shot; }
  const Plane& present(size_t k) const {
    static const Plane all;
    return k == 0 ? all : in_.neighbours[k - 1].present;
  }

  // Of each frame, from all of them.
  void make_pilots(std::vector<Light>& lights, float least) const {
    std::vector<Source> a, b;
    for (size_t k = 0; k < lights.size(); ++k) {
      const Light& l = lights[k];
      a.push_back({l.noisy.a, shot(k).features, l.noisy.b, l.variance_b, l.variance_a, present(k)});
      b.push_back({l.noisy.b, shot(k).features, l.noisy.a, l.variance_a, l.variance_b, present(k)});
    }
    for (size_t k = 0; k < lights.size(); ++k) {
      // A permutation: that which is estimated comes first, and whole.
      const Source &x = a[k], &y = b[k];
      std::vector<Source> of_a{{x.data, x.features, x.guide, x.variance, x.tolerance, present(0)}};
      std::vector<Source> of_b{{y.data, y.features, y.guide, y.variance, y.tolerance, present(0)}};
      for (size_t i = 0; i < lights.size(); ++i) {
        if (i == k) continue;
        of_a.push_back(a[i]);
        of_b.push_back(b[i]);
      }
      Light& l = lights[k];
      l.pilot.a = std::move(regressions(size_, of_a, {kPilotPatch, least}, kPilotBandwidth)[0]);
      l.pilot.b = std::move(regressions(size_, of_b, {kPilotPatch, least}, kPilotBandwidth)[0]);
      l.rest = differences(size_, l.pilot, 0.5f);
    }
  }

  // Estimates of both halves with all bandwidths.
  void make_candidates() {
    const auto least = static_cast<float>(1e-10 * light_ * light_);
    std::vector<Light> lights;
    for (size_t k = 0; k <= in_.neighbours.size(); ++k) lights.push_back(light_of(size_, shot(k)));
    make_pilots(lights, least);
    std::vector<Source> sources_a, sources_b;
    for (size_t k = 0; k < lights.size(); ++k) {
      const Light& l = lights[k];
      const Features& f = shot(k).features;
      sources_a.push_back({l.noisy.a, f, l.pilot.a, l.rest, l.variance_a, present(k)});
      sources_b.push_back({l.noisy.b, f, l.pilot.b, l.rest, l.variance_b, present(k)});
    }
    auto a = regressions(size_, sources_a, {kPatch, least}, kBandwidths);
    auto b = regressions(size_, sources_b, {kPatch, least}, kBandwidths);
    for (size_t k = 0; k < kBandwidths.size(); ++k) {
      by_albedo(a[k], Albedo::multiply, in_.shot.features);
      by_albedo(b[k], Albedo::multiply, in_.shot.features);
      candidates_.push_back({std::move(a[k]), std::move(b[k])});
    }
  }

  // Unbiased, of one channel of a pixel.
  float squared_error(const Halves& f, size_t c, size_t i) const {
    const float s_a = share_a_, s_b = 1 - share_a_;
    const float noise = noise_.a[c][i] - noise_.b[c][i];
    const float v_a = s_b * (noise * noise), v_b = s_a * (noise * noise);
    const float off_a = f.a[c][i] - noise_.b[c][i], off_b = f.b[c][i] - noise_.a[c][i];
    const float apart = f.a[c][i] - f.b[c][i];
    return s_a * (off_a * off_a - v_b) + s_b * (off_b * off_b - v_a) - s_a * s_b * (apart * apart);
  }
  Plane squared_error(const Halves& f) const {
    Plane error(size_.pixels());
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < error.size(); ++i) error[i] += per_[c][i] * squared_error(f, c, i);
    return error;
  }
  // Of a pixel, relative to the estimate itself.
  float relative_error(const Halves& f, size_t i) const {
    double error = 0;
    for (size_t c = 0; c < 3; ++c) {
      const double bright = static_cast<double>(share_a_ * f.a[c][i] + (1 - share_a_) * f.b[c][i]);
      error += static_cast<double>(squared_error(f, c, i)) /
               (3 * (bright * bright + kDark * light_ * light_));
    }
    return static_cast<float>(error);
  }
  // The same of the noisy picture.
  Plane noise_error() const {
    Plane error(size_.pixels());
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < error.size(); ++i) {
        const float noise = noise_.a[c][i] - noise_.b[c][i];
        error[i] += per_[c][i] * (share_a_ * (1 - share_a_) * (noise * noise));
      }
    return error;
  }

  // The bandwidth with the least error around each pixel, itself left out: its own noise would
  // favour the estimate that happens to be near it. `told`: relative_error() of what is chosen.
  Halves choose(Plane& told) {
    std::vector<Plane> errors, chosen(candidates_.size(), Plane(size_.pixels()));
    for (const Halves& candidate : candidates_)
      errors.push_back(smooth_others(squared_error(candidate), size_, kErrorSmoothing));
    told.resize(size_.pixels());
    for (size_t i = 0; i < size_.pixels(); ++i) {
      size_t best = 0;
      for (size_t k = 1; k < errors.size(); ++k)
        if (errors[k][i] < errors[best][i]) best = k;
      chosen[best][i] = 1;
      told[i] = relative_error(candidates_[best], i);
    }
    Halves all;
    for (size_t c = 0; c < 3; ++c) {
      all.a[c].resize(size_.pixels());
      all.b[c].resize(size_.pixels());
    }
    for (size_t k = 0; k < candidates_.size(); ++k) {
      const Plane share = smooth(chosen[k], size_, kChoiceSmoothing);
      for (size_t c = 0; c < 3; ++c)
        for (size_t i = 0; i < size_.pixels(); ++i) {
          all.a[c][i] += share[i] * candidates_[k].a[c][i];
          all.b[c][i] += share[i] * candidates_[k].b[c][i];
        }
      candidates_[k] = {};
    }
    return all;
  }

  // The combination of filter and noisy pixel with the least error, where the filter's error is
  // certain.
  void mix_with_noisy(Halves& f) const {
    Plane squares = squared_error(f);
    const Plane error = smooth(squares, size_, kErrorSmoothing);
    for (float& v : squares) v *= v;
    squares = smooth(squares, size_, kErrorSmoothing);
    const Plane noise = smooth(noise_error(), size_, kErrorSmoothing);
    // Number of pixels that the smoothing averages.
    const double n = 4 * std::numbers::pi * kErrorSmoothing * kErrorSmoothing;
    for (size_t i = 0; i < error.size(); ++i) {
      const auto e = static_cast<double>(error[i]), v = static_cast<double>(noise[i]);
      const double deviation =
          std::sqrt(std::max(0.0, static_cast<double>(squares[i]) - e * e) / n);
      const double sure = kFew * (e - kCertain * deviation);
      if (!(sure > 0)) continue;
      const auto share = static_cast<float>(sure / (sure + v));
      for (size_t c = 0; c < 3; ++c) {
        f.a[c][i] += share * (noise_.a[c][i] - f.a[c][i]);
        f.b[c][i] += share * (noise_.b[c][i] - f.b[c][i]);
      }
    }
  }

  const Input in_;
  const Size size_;
  const float share_a_;
  const double light_;  // mean radiance of the picture
  const Halves noise_;
  Colour per_;  // factors of squared errors
  std::vector<Halves> candidates_;
};

// How far apart two pixels can be that affect each other: filters reach three deviations, medians
// one pixel.
constexpr int kHalo = 2 * (5 + 1) + (kReach + kPilotPatch) + (kReach + kPatch) + 2 * 9 + 6;

// A part of the input, with its halo as far as the picture goes.
struct Block {
  int x, y, width, height;       // in the picture
  int left, top, right, bottom;  // the same with the halo
  Size size() const { return {right - left, bottom - top}; }
};

Block block_of(Size size, int x, int y, int width, int height) {
  return {x,
          y,
          width,
          height,
          std::max(0, x - kHalo),
          std::max(0, y - kHalo),
          std::min(size.width, x + width + kHalo),
          std::min(size.height, y + height + kHalo)};
}

Plane part(const Plane& plane, Size size, const Block& block) {
  Plane some;
  some.reserve(block.size().pixels());
  for (int y = block.top; y < block.bottom; ++y) {
    const auto row = plane.begin() + static_cast<std::ptrdiff_t>(y) * size.width;
    some.insert(some.end(), row + block.left, row + block.right);
  }
  return some;
}

Shot part(const Shot& shot, Size size, const Block& block) {
  Shot some;
  some.share_a = shot.share_a;
  for (size_t c = 0; c < 3; ++c) {
    some.a[c] = part(shot.a[c], size, block);
    some.b[c] = part(shot.b[c], size, block);
  }
  for (size_t f = 0; f < kFeatures; ++f) some.features[f] = part(shot.features[f], size, block);
  return some;
}

Input part(const Input& input, const Block& block) {
  Input some{block.size(), part(input.shot, input.size, block)};
  for (const Neighbour& n : input.neighbours)
    some.neighbours.push_back(
        {part(n.shot, input.size, block), part(n.present, input.size, block)});
  return some;
}

// Copies what is not halo.
void put(const Plane& from, const Block& block, Plane& picture, Size size) {
  for (int y = block.y; y < block.y + block.height; ++y) {
    const auto row = from.begin() +
                     static_cast<std::ptrdiff_t>(y - block.top) * (block.right - block.left) +
                     (block.x - block.left);
    std::copy(row, row + block.width,
              picture.begin() + static_cast<std::ptrdiff_t>(y) * size.width + block.x);
  }
}

// Divides all light by a power of two, so that the mean is about 1 and squares are in the range of
// floats. Returns the exponent.
int normalise(Input& input) {
  const double light =
      mean_of(mean({input.shot.a, input.shot.b}, static_cast<float>(input.shot.share_a)));
  if (!(light > 0)) return 0;
  const int exponent = std::ilogb(light);
  const auto divide = [&](Shot& shot) {
    for (Colour* half : {&shot.a, &shot.b})
      for (Plane& plane : *half)
        for (float& v : plane) v = std::min(std::ldexp(v, -exponent), kBrightest);
  };
  divide(input.shot);
  for (Neighbour& n : input.neighbours) divide(n.shot);
  return exponent;
}

// Makes squares errors, with kUntold. Returns the mean of the squares, at least 0.
double take_roots(Plane& error) {
  const double mean_square = kUntold * mean_of(error);
  for (float& v : error) v = std::sqrt(static_cast<float>(kUntold) * std::max(v, 0.0f));
  return std::max(mean_square, 0.0);
}

}  // namespace

Result denoise(Input input, int block) {
  const Size size = input.size;
  Shot& shot = input.shot;
  const int exponent = normalise(input);
  const auto share_a = static_cast<float>(shot.share_a);
  Result result;
  result.picture = mean({shot.a, shot.b}, share_a);
  const Colour noisy = result.picture;
  result.error.resize(size.pixels());
  const double light = mean_of(noisy);
  if (!(light > 0)) return result;  // black
  Outliers a = cut_outliers(size, shot.a, shot.b), b = cut_outliers(size, shot.b, shot.a);
  shot.a = std::move(a.rest);
  shot.b = std::move(b.rest);
  result.outliers = a.pixels + b.pixels;
  result.outlier_energy = 1 - mean_of(mean({shot.a, shot.b}, share_a)) / light;
  const int across = (size.width + block - 1) / block, down = (size.height + block - 1) / block;
  for (int i = 0; i < across * down; ++i) {
    const auto edge = [](int64_t k, int of, int length) {
      return static_cast<int>(k * length / of);
    };
    const int x = edge(i % across, across, size.width), y = edge(i / across, down, size.height);
    const Block some = block_of(size, x, y, edge(i % across + 1, across, size.width) - x,
                                edge(i / across + 1, down, size.height) - y);
    const Filter::Estimate estimate = Filter(part(input, some), light).run();
    for (size_t c = 0; c < 3; ++c) put(estimate.picture[c], some, result.picture[c], size);
    put(estimate.error, some, result.error, size);
  }
  result.relmse = take_roots(result.error);
  restore_energy(size, noisy, result.picture);
  for (Plane& plane : result.picture)
    for (float& v : plane) v = std::ldexp(v, exponent);
  return result;
}

}  // namespace tdpt::denoise
