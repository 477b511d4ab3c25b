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
// How often the picture is halved, and the least side of what is halved [pixels].
constexpr int kHalvings = 2, kLeastSide = 16;
// The light is filtered after division by the albedo plus this.
constexpr float kAlbedoOffset = 0.5f;
// Deviations of filters [pixels]: of variances, of errors, of noise that tells how certain they
// are, of what is chosen, of brightness, of the error that is told.
constexpr double kVarianceSmoothing = 1.5, kErrorSmoothing = 3, kNoiseSmoothing = 9,
                 kChoiceSmoothing = 2, kBrightnessSmoothing = 2, kMapSmoothing = 5;
// By so many standard errors a finer resolution, the noisy pixel, and our own filter beside a guest
// must be better to be taken. The guest of all samples is better than its halves tell.
constexpr double kCertainDetail = 4, kCertainNoisy = 10, kCertainOwn = 2;

// How many times as bright as itself a pixel's neighbours count, and what is added to brightness,
// of the mean radiance.
constexpr float kBrighter = 2, kDim = 0.01f;
constexpr double kDark = 0.01;       // as in relMSE
constexpr float kBrightest = 1e12f;  // over the mean of this picture; only other frames have it
// The error is told of pictures with so many tiles, and so few outliers for each pixel; the truth
// is within that factor of it.
constexpr int kTile = 16;  // [pixels]
constexpr size_t kFewestTiles = 8;
constexpr double kMostOutliers = 0.01, kWithin = 2, kUntold = 1.25;

struct Halves {
  Colour a, b;
};

Colour mean(const Colour& a, const Colour& b, float share_a) {
  Colour all = a;
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < all[c].size(); ++i)
      all[c][i] = share_a * a[c][i] + (1 - share_a) * b[c][i];
  return all;
}

// Squared differences, smoothed, times a factor. What a pixel has of brighter ones is limited as if
// they were kBrighter times as bright as it: beside a lamp there is no noise of the lamp's size.
Colour differences(Size size, const Colour& a, const Colour& b, float factor) {
  Colour all;
  for (size_t c = 0; c < 3; ++c) {
    Plane bright(size.pixels()), squares(size.pixels()), relative(size.pixels());
    for (size_t i = 0; i < bright.size(); ++i) bright[i] = 0.5f * (a[c][i] + b[c][i]);
    bright = medians(bright, size);
    for (float& of : bright) of = (of + kDim) * (of + kDim);
    for (size_t i = 0; i < squares.size(); ++i) {
      const float d = a[c][i] - b[c][i];
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

void divide_by_albedo(Shot& shot) {
  by_albedo(shot.a, Albedo::divide, shot.features);
  by_albedo(shot.b, Albedo::divide, shot.features);
}

// Crude estimates of a frame's halves, and variances.
struct Crude {
  Colour variance_a, variance_b;
  Halves pilot{};
  Colour rest{};  ///< variance of the pilot
};

// Tells by the halves which of two estimates is nearer to the truth. All is light.
class Judge {
 public:
  /// `light`: mean radiance. Keeps a reference to the shot.
  Judge(Size size, const Shot& shot, double light)
      : size_(size), share_a_(static_cast<float>(shot.share_a)), noisy_(shot) {
    // Squared errors are relative to the brightness around, as in relMSE.
    per_ = mean(shot.a, shot.b, share_a_);
    by_albedo(per_, Albedo::multiply, shot.features);
    for (Plane& plane : per_) {
      plane = smooth(plane, size_, kBrightnessSmoothing);
      for (float& v : plane) {
        const auto bright = static_cast<double>(v);
        v = static_cast<float>(1 / (3 * (bright * bright + kDark * light * light)));
      }
    }
    by_albedo(per_, Albedo::multiply, shot.features);
    by_albedo(per_, Albedo::multiply, shot.features);
    noise_.resize(size.pixels());
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < noise_.size(); ++i) {
        const float apart = shot.a[c][i] - shot.b[c][i];
        noise_[i] += per_[c][i] * share_a_ * (1 - share_a_) * (apart * apart);
      }
    noise_ = smooth(noise_, size_, kNoiseSmoothing);
  }

  // The share w of the way from one estimate, f, to another, f + d, that has the least error around
  // each pixel, itself left out: its own noise would favour the estimate that happens to be near
  // it. The error is quadratic in w:
  //   w = (x - certain^2 v / x) / y   if x > certain sqrt(v), else 0;  at most 1
  // x the products of d with what f lacks, y the squares of d, v the variance of x. So what differs
  // from f by chance is not taken [as James and Stein's estimator].
  Plane share(const Halves& from, const Halves& to, double certain) const {
    const float s_a = share_a_, s_b = 1 - share_a_;
    Plane gain(size_.pixels()), squares(size_.pixels());
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < gain.size(); ++i) {
        const float d_a = to.a[c][i] - from.a[c][i], d_b = to.b[c][i] - from.b[c][i];
        const float d = s_a * d_a + s_b * d_b;
        gain[i] += per_[c][i] * (s_a * (noisy_.b[c][i] - from.a[c][i]) * d_a +
                                 s_b * (noisy_.a[c][i] - from.b[c][i]) * d_b +
                                 s_a * s_b * (from.a[c][i] - from.b[c][i]) * (d_a - d_b));
        squares[i] += per_[c][i] * (d * d);
      }
    gain = smooth_others(gain, size_, kErrorSmoothing);
    squares = smooth(squares, size_, kErrorSmoothing);
    // Number of pixels that the smoothing averages.
    const double n = 4 * std::numbers::pi * kErrorSmoothing * kErrorSmoothing;
    for (size_t i = 0; i < gain.size(); ++i) {
      const auto x = static_cast<double>(gain[i]), y = static_cast<double>(squares[i]);
      const double v = certain * certain * y * static_cast<double>(noise_[i]) / n;
      gain[i] = x > 0 && y > 0 ? static_cast<float>(std::clamp((x - v / x) / y, 0.0, 1.0)) : 0.0f;
    }
    return gain;
  }

  // Unbiased, of one channel of a pixel.
  float squared_error(const Halves& f, size_t c, size_t i) const {
    const float s_a = share_a_, s_b = 1 - share_a_;
    const float noise = noisy_.a[c][i] - noisy_.b[c][i];
    const float v_a = s_b * (noise * noise), v_b = s_a * (noise * noise);
    const float off_a = f.a[c][i] - noisy_.b[c][i], off_b = f.b[c][i] - noisy_.a[c][i];
    const float apart = f.a[c][i] - f.b[c][i];
    return s_a * (off_a * off_a - v_b) + s_b * (off_b * off_b - v_a) - s_a * s_b * (apart * apart);
  }

 private:
  const Size size_;
  const float share_a_;
  const Shot& noisy_;
  Colour per_;   // factors of squared errors
  Plane noise_;  // relative variance of the noise
};

void move_toward(Halves& from, const Halves& to, const Plane& share) {
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < share.size(); ++i) {
      from.a[c][i] += share[i] * (to.a[c][i] - from.a[c][i]);
      from.b[c][i] += share[i] * (to.b[c][i] - from.b[c][i]);
    }
}

// Filters a part of a picture, of which shots are light, at one resolution.
class Filter {
 public:
  Filter(Input in, double light)
      : in_(std::move(in)),
        size_(in_.size),
        least_(static_cast<float>(1e-10 * light * light)),
        judge_(size_, in_.shot, light) {}

  // From the widest bandwidth on as far as the narrower ones are better.
  Halves run() const {
    const std::vector<Crude> crude = make_pilots();
    auto a = candidates(crude, &Shot::a, &Halves::a), b = candidates(crude, &Shot::b, &Halves::b);
    Halves best{std::move(a.back()), std::move(b.back())};
    for (size_t k = a.size() - 1; k-- > 0;) {
      const Halves narrower{std::move(a[k]), std::move(b[k])};
      const Plane share = judge_.share(best, narrower, 0);
      move_toward(best, narrower, smooth(share, size_, kChoiceSmoothing));
    }
    return best;
  }

 private:
  const Shot& shot(size_t k) const { return k == 0 ? in_.shot : in_.neighbours[k - 1].shot; }
  const Plane& present(size_t k) const {
    static const Plane all;
    return k == 0 ? all : in_.neighbours[k - 1].present;
  }

  // Of each frame, from all of them.
  std::vector<Crude> make_pilots() const {
    std::vector<Crude> all(1 + in_.neighbours.size());
    std::vector<Source> a, b;
    for (size_t k = 0; k < all.size(); ++k) {
      const Shot& s = shot(k);
      const auto share_a = static_cast<float>(s.share_a);
      Crude& of = all[k];
      of.variance_a = differences(size_, s.a, s.b, 1 - share_a);
      of.variance_b = differences(size_, s.a, s.b, share_a);
      a.push_back({s.a, s.features, s.b, of.variance_b, of.variance_a, present(k)});
      b.push_back({s.b, s.features, s.a, of.variance_a, of.variance_b, present(k)});
    }
    for (size_t k = 0; k < all.size(); ++k) {
      // A permutation: that which is estimated comes first, and whole.
      const Source &x = a[k], &y = b[k];
      std::vector<Source> of_a{{x.data, x.features, x.guide, x.variance, x.tolerance, present(0)}};
      std::vector<Source> of_b{{y.data, y.features, y.guide, y.variance, y.tolerance, present(0)}};
      for (size_t i = 0; i < all.size(); ++i) {
        if (i == k) continue;
        of_a.push_back(a[i]);
        of_b.push_back(b[i]);
      }
      Halves& pilot = all[k].pilot;
      pilot.a = std::move(regressions(size_, of_a, {kPilotPatch, least_}, kPilotBandwidth)[0]);
      pilot.b = std::move(regressions(size_, of_b, {kPilotPatch, least_}, kPilotBandwidth)[0]);
      all[k].rest = differences(size_, pilot.a, pilot.b, 0.5f);
    }
    return all;
  }

  // Estimates of one half with all bandwidths.
  std::vector<Colour> candidates(const std::vector<Crude>& crude, Colour Shot::*noisy,
                                 Colour Halves::*half) const {
    std::vector<Source> sources;
    for (size_t k = 0; k < crude.size(); ++k) {
      const Crude& of = crude[k];
      const Colour& tolerance = half == &Halves::a ? of.variance_a : of.variance_b;
      sources.push_back(
          {shot(k).*noisy, shot(k).features, of.pilot.*half, of.rest, tolerance, present(k)});
    }
    return regressions(size_, sources, {kPatch, least_}, kBandwidths);
  }

  const Input in_;
  const Size size_;
  const float least_;
  const Judge judge_;
};

// How far apart two pixels can be that affect each other at one resolution: filters reach three
// deviations, medians one pixel.
constexpr int kHalo = 2 * (5 + 1) + (kReach + kPilotPatch) + (kReach + kPatch) + 2 * (9 + 6);

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

Halves in_blocks(const Input& input, double light, int block) {
  const Size size = input.size;
  Halves all;
  for (Colour* half : {&all.a, &all.b}) half->fill(Plane(size.pixels()));
  const int across = (size.width + block - 1) / block, down = (size.height + block - 1) / block;
  for (int i = 0; i < across * down; ++i) {
    const auto edge = [](int64_t k, int of, int length) {
      return static_cast<int>(k * length / of);
    };
    const int x = edge(i % across, across, size.width), y = edge(i / across, down, size.height);
    const Block some = block_of(size, x, y, edge(i % across + 1, across, size.width) - x,
                                edge(i / across + 1, down, size.height) - y);
    const Halves estimate = Filter(part(input, some), light).run();
    for (size_t c = 0; c < 3; ++c) {
      put(estimate.a[c], some, all.a[c], size);
      put(estimate.b[c], some, all.b[c], size);
    }
  }
  return all;
}

Colour halved(const Colour& colour, Size size) {
  return {halved(colour[0], size), halved(colour[1], size), halved(colour[2], size)};
}
Shot halved(const Shot& shot, Size size) {
  Shot half{halved(shot.a, size), halved(shot.b, size), shot.share_a, {}};
  for (size_t f = 0; f < kFeatures; ++f) half.features[f] = halved(shot.features[f], size);
  return half;
}
Input halved(const Input& input) {
  Input half{half_of(input.size), halved(input.shot, input.size)};
  for (const Neighbour& n : input.neighbours) {
    Neighbour small{halved(n.shot, input.size), halved(n.present, input.size)};
    for (float& v : small.present) v = v < 1 ? 0.0f : 1.0f;
    half.neighbours.push_back(std::move(small));
  }
  return half;
}

// Gives a plane the brightness of a coarse one, and keeps its details: a factor, which leaves what
// is dark beside a lamp dark.
void follow(Plane& fine, const Plane& small, const Plane& coarse, const Plane& share, Size size) {
  Plane change(small.size());
  for (size_t i = 0; i < change.size(); ++i)
    change[i] = (1 - share[i]) * ((coarse[i] + kDim) / (small[i] + kDim) - 1);
  change = doubled(change, size);
  for (size_t i = 0; i < fine.size(); ++i)
    fine[i] = std::max(fine[i] + (fine[i] + kDim) * change[i], 0.0f);
}

// A picture, of which shots are light, at one resolution and at half of it, and so on. Where there
// are no details that are certain, the coarser one tells the brightness: its noise is less.
Halves filtered(const Input& input, double light, int block, int halvings) {
  const Size size = input.size;
  Halves best = in_blocks(input, light, block);
  if (halvings > 0 && std::min(size.width, size.height) >= kLeastSide) {
    const Input half = halved(input);
    const Halves coarse = filtered(half, light, block, halvings - 1);
    const Halves small{halved(best.a, size), halved(best.b, size)};
    const Judge judge(half.size, half.shot, light);
    const Plane share =
        smooth(judge.share(coarse, small, kCertainDetail), half.size, kChoiceSmoothing);
    for (size_t c = 0; c < 3; ++c) {
      follow(best.a[c], small.a[c], coarse.a[c], share, size);
      follow(best.b[c], small.b[c], coarse.b[c], share, size);
    }
  }
  const Halves noisy{input.shot.a, input.shot.b};
  const Judge judge(size, input.shot, light);
  move_toward(best, noisy, judge.share(best, noisy, kCertainNoisy));
  return best;
}

// Divides all light by a power of two, so that the mean is about 1 and squares are in the range of
// floats. Returns the exponent.
int normalise(Input& input) {
  const double light =
      mean_of(mean(input.shot.a, input.shot.b, static_cast<float>(input.shot.share_a)));
  if (!(light > 0)) return 0;
  const int exponent = std::ilogb(light);
  const auto divide = [&](Shot& shot) {
    for (Colour* half : {&shot.a, &shot.b})
      for (Plane& plane : *half)
        for (float& v : plane) v = std::min(std::ldexp(v, -exponent), kBrightest);
  };
  divide(input.shot);
  if (input.guest)
    for (Colour* colour : {&input.guest->a, &input.guest->b, &input.guest->all})
      for (Plane& plane : *colour)
        for (float& v : plane) v = v > 0 ? std::min(std::ldexp(v, -exponent), kBrightest) : 0;
  for (Neighbour& n : input.neighbours) divide(n.shot);
  return exponent;
}

// Of each pixel, relative to the estimate itself: its squared error, and the variance of the
// estimate, both by the halves; and that of the noise, in the mean.
struct Squares {
  Plane error, variance;
  double noise = 0;
};
Squares squares_of(const Input& input, const Halves& f, double light) {
  const auto share_a = static_cast<float>(input.shot.share_a);
  const Judge judge(input.size, input.shot, light);
  Squares all{Plane(input.size.pixels()), Plane(input.size.pixels())};
  const Colour picture = mean(f.a, f.b, share_a);
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < all.error.size(); ++i) {
      const double albedo = static_cast<double>(input.shot.features[c][i] + kAlbedoOffset);
      const double bright = albedo * static_cast<double>(picture[c][i]);
      const auto per =
          static_cast<float>(albedo * albedo / (3 * (bright * bright + kDark * light * light)));
      const float apart = f.a[c][i] - f.b[c][i];
      all.error[i] += per * judge.squared_error(f, c, i);
      all.variance[i] += per * share_a * (1 - share_a) * apart * apart;
      const float noise = input.shot.a[c][i] - input.shot.b[c][i];
      all.noise += static_cast<double>(per * share_a * (1 - share_a) * noise * noise);
    }
  all.noise /= static_cast<double>(input.size.pixels());
  return all;
}

// Standard error of a plane's mean, by the means of tiles; nothing if those are few.
std::optional<double> deviation_of_mean(const Plane& plane, Size size) {
  const int across = size.width / kTile, down = size.height / kTile;
  const auto count = static_cast<size_t>(across) * static_cast<size_t>(down);
  if (count < kFewestTiles) return {};
  std::vector<double> tiles(count);
  for (int y = 0; y < down * kTile; ++y)
    for (int x = 0; x < across * kTile; ++x)
      tiles[static_cast<size_t>(y / kTile * across + x / kTile)] += static_cast<double>(
          plane[static_cast<size_t>(y) * static_cast<size_t>(size.width) + static_cast<size_t>(x)]);
  const auto n = static_cast<double>(count);
  double mean = 0, squares = 0;
  for (const double t : tiles) mean += t / n;
  for (const double t : tiles) squares += (t - mean) * (t - mean);
  return std::sqrt(squares) / (n * kTile * kTile);
}

// Tells what error is left [denoise.h], if that is known.
void tell_error(const Squares& squares, Size size, Result& result) {
  const std::optional<double> deviation = deviation_of_mean(squares.error, size);
  if (!deviation ||
      static_cast<double>(result.outliers) > kMostOutliers * static_cast<double>(size.pixels()))
    return;
  const double kept = mean_of(squares.variance);
  const double lost = squares.noise > 0 ? std::max(1 - std::sqrt(kept / squares.noise), 0.0) : 0;
  const double relmse =
      kUntold * (std::max(mean_of(squares.error), 0.0) + lost * kept) + *deviation / 2;
  result.left = {relmse, relmse / kWithin, relmse * kWithin};
  result.error = smooth(squares.error, size, kMapSmoothing);
  const Plane variance = smooth(squares.variance, size, kMapSmoothing);
  for (size_t i = 0; i < variance.size(); ++i)
    result.error[i] = std::max(result.error[i], 0.0f) + variance[i];
  const double sum = mean_of(result.error);
  for (float& v : result.error)
    v = sum > 0 ? std::sqrt(static_cast<float>(static_cast<double>(v) * relmse / sum)) : 0;
}

// Combines the halves, and their mean, with a guest's: the guest's where ours is not better.
Colour with_guest(Guest& guest, const Input& input, double light, Halves& best) {
  for (Colour* colour : {&guest.a, &guest.b, &guest.all})
    by_albedo(*colour, Albedo::divide, input.shot.features);
  const auto share_a = static_cast<float>(input.shot.share_a);
  const Judge judge(input.size, input.shot, light);
  Halves all{std::move(guest.a), std::move(guest.b)};
  const Plane share = smooth(judge.share(all, best, kCertainOwn), input.size, kChoiceSmoothing);
  Colour picture = mean(best.a, best.b, share_a);
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < share.size(); ++i)
      picture[c][i] = guest.all[c][i] + share[i] * (picture[c][i] - guest.all[c][i]);
  move_toward(all, best, share);
  best = std::move(all);
  return picture;
}

}  // namespace

Result denoise(Input input, int block) {
  const Size size = input.size;
  Shot& shot = input.shot;
  const int exponent = normalise(input);
  const auto share_a = static_cast<float>(shot.share_a);
  const Halves noisy{shot.a, shot.b};
  Result result;
  result.picture = mean(noisy.a, noisy.b, share_a);
  const double light = mean_of(result.picture);
  if (!(light > 0)) return result;  // black
  Outliers a = cut_outliers(size, shot.a, shot.b), b = cut_outliers(size, shot.b, shot.a);
  shot.a = std::move(a.rest);
  shot.b = std::move(b.rest);
  result.outliers = a.pixels + b.pixels;
  divide_by_albedo(shot);
  for (Neighbour& n : input.neighbours) divide_by_albedo(n.shot);
  Halves best = filtered(input, light, block, kHalvings);
  result.picture =
      input.guest ? with_guest(*input.guest, input, light, best) : mean(best.a, best.b, share_a);
  tell_error(squares_of(input, best, light), size, result);
  by_albedo(result.picture, Albedo::multiply, shot.features);
  restore_light(size, noisy.a, noisy.b, share_a, result.picture);
  result.left_out = std::max(1 - mean_of(result.picture) / light, 0.0);
  for (Plane& plane : result.picture)
    for (float& v : plane) v = std::ldexp(v, exponent);
  return result;
}

}  // namespace tdpt::denoise
