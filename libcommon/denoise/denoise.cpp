#include "libcommon/denoise/denoise.h"

#include <algorithm>
#include <cmath>

#include "libcommon/denoise/judge.h"

namespace tdpt::denoise {
namespace {

constexpr std::array kPilotBandwidth{0.5f};
constexpr std::array kBandwidths{0.25f, 0.5f, 1.0f};
constexpr int kPilotPatch = 3, kPatch = 1;
// How often the picture is halved, and the least side of what is halved [pixels].
constexpr int kHalvings = 2, kLeastSide = 16;
// Deviations of filters [pixels]: of variances, of what is chosen.
constexpr double kVarianceSmoothing = 1.5, kChoiceSmoothing = 2;
// By so many standard errors a finer resolution, the noisy pixel, and our own filter beside a guest
// must be better to be taken. The guest of all samples is better than its halves tell.
constexpr double kCertainDetail = 4, kCertainNoisy = 10, kCertainOwn = 2;
// How many times as bright as itself a pixel's neighbours count, and what is added to brightness,
// of the mean radiance.
constexpr float kBrighter = 2, kDim = 0.01f;
constexpr float kBrightest = 1e12f;  // over the mean of this picture; only other frames have it

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

// Crude estimates of a frame's halves, and variances.
struct Crude {
  Colour variance_a, variance_b;
  Halves pilot{};
  Colour rest{};  ///< variance of the pilot
};

void move_toward(Halves& from, const Halves& to, const Plane& share) {
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < share.size(); ++i) {
      from.a[c][i] += share[i] * (to.a[c][i] - from.a[c][i]);
      from.b[c][i] += share[i] * (to.b[c][i] - from.b[c][i]);
    }
}

// Filters a picture, whose halves are light, at one resolution.
class Filter {
 public:
  Filter(const Input& in, double light)
      : in_(in),
        size_(in_.size),
        least_(static_cast<float>(1e-10 * light * light)),
        judge_(size_, in_.halves, light) {}

  // From the widest bandwidth on as far as the narrower ones are better.
  Halves run() const {
    const std::vector<Crude> crude = make_pilots();
    auto a = candidates(crude, &NoisyHalves::a, &Halves::a),
         b = candidates(crude, &NoisyHalves::b, &Halves::b);
    Halves best{std::move(a.back()), std::move(b.back())};
    for (size_t k = a.size() - 1; k-- > 0;) {
      const Halves narrower{std::move(a[k]), std::move(b[k])};
      const Plane share = judge_.share(best, narrower, 0);
      move_toward(best, narrower, smooth(share, size_, kChoiceSmoothing));
    }
    return best;
  }

 private:
  const NoisyHalves& halves(size_t k) const {
    return k == 0 ? in_.halves : in_.neighbours[k - 1].halves;
  }
  const Plane& present(size_t k) const {
    static const Plane all;
    return k == 0 ? all : in_.neighbours[k - 1].present;
  }

  // The crude estimates of each frame, from all of them.
  std::vector<Crude> make_pilots() const {
    std::vector<Crude> all(1 + in_.neighbours.size());
    std::vector<Source> a, b;
    for (size_t k = 0; k < all.size(); ++k) {
      const NoisyHalves& s = halves(k);
      const auto share_a = static_cast<float>(s.share_a);
      Crude& of = all[k];
      of.variance_a = differences(size_, s.a, s.b, 1 - share_a);
      of.variance_b = differences(size_, s.a, s.b, share_a);
      a.push_back({s.a, s.features, s.b, of.variance_b, of.variance_a, present(k)});
      b.push_back({s.b, s.features, s.a, of.variance_a, of.variance_b, present(k)});
    }
    // The frame that is estimated comes first, and whole.
    const auto pilot_of = [&](const std::vector<Source>& sources, size_t k) {
      const Source& own = sources[k];
      std::vector<Source> ordered{
          {own.data, own.features, own.guide, own.variance, own.tolerance, present(0)}};
      for (size_t i = 0; i < sources.size(); ++i)
        if (i != k) ordered.push_back(sources[i]);
      return std::move(regressions(size_, ordered, {kPilotPatch, least_}, kPilotBandwidth)[0]);
    };
    for (size_t k = 0; k < all.size(); ++k) {
      all[k].pilot = {pilot_of(a, k), pilot_of(b, k)};
      all[k].rest = differences(size_, all[k].pilot.a, all[k].pilot.b, 0.5f);
    }
    return all;
  }

  // Estimates of one half with all bandwidths.
  std::vector<Colour> candidates(const std::vector<Crude>& crude, Colour NoisyHalves::*noisy,
                                 Colour Halves::*half) const {
    std::vector<Source> sources;
    for (size_t k = 0; k < crude.size(); ++k) {
      const Crude& of = crude[k];
      const Colour& tolerance = half == &Halves::a ? of.variance_a : of.variance_b;
      sources.push_back(
          {halves(k).*noisy, halves(k).features, of.pilot.*half, of.rest, tolerance, present(k)});
    }
    return regressions(size_, sources, {kPatch, least_}, kBandwidths);
  }

  const Input& in_;
  const Size size_;
  const float least_;
  const Judge judge_;
};

Colour halved(const Colour& colour, Size size) {
  return {halved(colour[0], size), halved(colour[1], size), halved(colour[2], size)};
}
NoisyHalves halved(const NoisyHalves& halves, Size size) {
  NoisyHalves half{halved(halves.a, size), halved(halves.b, size), halves.share_a, {}};
  for (size_t f = 0; f < kFeatures; ++f) half.features[f] = halved(halves.features[f], size);
  return half;
}
Input halved(const Input& input) {
  Input half{half_of(input.size), halved(input.halves, input.size)};
  for (const Neighbour& n : input.neighbours) {
    Neighbour small{halved(n.halves, input.size), halved(n.present, input.size)};
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

// A picture, whose halves are light, at one resolution and at half of it, and so on. Where there
// are no details that are certain, the coarser one tells the brightness: its noise is less.
Halves filtered(const Input& input, double light, int halvings) {
  const Size size = input.size;
  Halves best = Filter(input, light).run();
  if (halvings > 0 && std::min(size.width, size.height) >= kLeastSide) {
    const Input half = halved(input);
    const Halves coarse = filtered(half, light, halvings - 1);
    const Halves small{halved(best.a, size), halved(best.b, size)};
    const Judge judge(half.size, half.halves, light);
    const Plane share =
        smooth(judge.share(coarse, small, kCertainDetail), half.size, kChoiceSmoothing);
    for (size_t c = 0; c < 3; ++c) {
      follow(best.a[c], small.a[c], coarse.a[c], share, size);
      follow(best.b[c], small.b[c], coarse.b[c], share, size);
    }
  }
  const Halves noisy{input.halves.a, input.halves.b};
  const Judge judge(size, input.halves, light);
  move_toward(best, noisy, judge.share(best, noisy, kCertainNoisy));
  return best;
}

// Divides all light by a power of two, so that the mean is about 1 and squares are in the range of
// floats. Returns the exponent.
int normalise(Input& input) {
  const double light =
      mean_of(mean(input.halves.a, input.halves.b, static_cast<float>(input.halves.share_a)));
  if (!(light > 0)) return 0;
  const int exponent = std::ilogb(light);
  const auto divide = [&](std::initializer_list<Colour*> colours) {
    for (Colour* const colour : colours)
      for (Plane& plane : *colour)
        for (float& v : plane) v = v > 0 ? std::min(std::ldexp(v, -exponent), kBrightest) : 0;
  };
  divide({&input.halves.a, &input.halves.b});
  if (input.guest) divide({&input.guest->a, &input.guest->b, &input.guest->all});
  for (Neighbour& n : input.neighbours) divide({&n.halves.a, &n.halves.b});
  return exponent;
}

// Combines the halves, and their mean, with a guest's: the guest's where ours is not better.
Colour with_guest(Guest& guest, const Input& input, double light, Halves& best) {
  for (Colour* colour : {&guest.a, &guest.b, &guest.all})
    by_albedo(*colour, Albedo::divide, input.halves.features);
  const auto share_a = static_cast<float>(input.halves.share_a);
  const Judge judge(input.size, input.halves, light);
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

Result denoise(Input input) {
  const Size size = input.size;
  NoisyHalves& halves = input.halves;
  const int exponent = normalise(input);
  const auto share_a = static_cast<float>(halves.share_a);
  const Halves noisy{halves.a, halves.b};
  Result result;
  result.picture = mean(noisy.a, noisy.b, share_a);
  const double light = mean_of(result.picture);
  if (!(light > 0)) return result;  // black
  result.outliers = cut_outliers(size, halves.a, halves.b);
  const auto divide_by_albedo = [](NoisyHalves& of) {
    for (Colour* const half : {&of.a, &of.b}) by_albedo(*half, Albedo::divide, of.features);
  };
  divide_by_albedo(halves);
  for (Neighbour& n : input.neighbours) divide_by_albedo(n.halves);
  Halves best = filtered(input, light, kHalvings);
  result.picture =
      input.guest ? with_guest(*input.guest, input, light, best) : mean(best.a, best.b, share_a);
  estimate_error(input, best, light, result);
  by_albedo(result.picture, Albedo::multiply, halves.features);
  restore_light(size, noisy.a, noisy.b, share_a, result.picture);
  result.left_out = std::max(1 - mean_of(result.picture) / light, 0.0);
  for (Plane& plane : result.picture)
    for (float& v : plane) v = std::ldexp(v, exponent);
  return result;
}

}  // namespace tdpt::denoise
