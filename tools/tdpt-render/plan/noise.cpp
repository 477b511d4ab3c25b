#include "tools/tdpt-render/plan/noise.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "libcommon/base/words.h"

namespace tdpt {

// ---- By an error pilot ----

namespace {

constexpr double kDark = 0.01;  // as exrdiff's relMSE
// Samples of the pilot, over all pixels. With fewer than kFewestSamples samples small pictures give
// no estimate; after kDarkness samples, and kDarkEach per pixel, without light the pilot stops.
constexpr uint64_t kFewestSamples = uint64_t{1} << 14, kDarkness = uint64_t{1} << 20,
                   kDarkEach = 64;
// A fourth of the picture's samples is enough in any case; an eighth, and at most kMostIfKnown
// samples per pixel, if the estimate is good.
constexpr uint64_t kShare = 4, kShareIfKnown = 8, kMostIfKnown = uint64_t{1} << 15;
constexpr double kKnown = 0.1, kCalm = 0.3;
// Where the picture takes at most that many samples per pixel, a fourth of them may give no
// estimate, and more are cheap.
constexpr uint64_t kFewSamples = 32;

double mean_magnitude(const PictureParts& parts) {
  double sum = 0;
  for (const auto& part : parts)
    for (const Rgb& p : part)
      for (int c = 0; c < 3; ++c) sum += std::abs(static_cast<double>(p[c]));
  return sum / (3 * static_cast<double>(parts.size() * parts[0].size()));
}

// One component of one pixel.
struct PartTerms {
  double high = 0, low = 0, denominator = 1, sum = 0;
};

PartTerms part_terms(const PictureParts& parts, size_t pixel, int c, double dark) {
  const auto x = [&](size_t k) { return static_cast<double>(parts[k][pixel][c]); };
  const size_t count = parts.size();
  const auto n = static_cast<double>(count);
  PartTerms t;
  for (size_t k = 0; k < count; ++k) t.sum += x(k);
  const double m = t.sum / n;
  double v = 0;
  for (size_t k = 0; k < count; ++k) v += (x(k) - m) * (x(k) - m) / (n - 1);
  t.denominator = std::max(m * m - v / n, 0.0) + dark;
  t.low = v / t.denominator;
  for (size_t a = 0; count > 2 && a < count; ++a) {
    const size_t b = (a + 1) % count;
    const double d = x(a) - x(b), rest = (t.sum - x(a) - x(b)) / (n - 2);
    t.high += d * d / 2 / (rest * rest + dark) / n;
  }
  return t;
}

// Relative standard error of the mean of a small sample.
double relative_error(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double mean = 0, squares = 0;
  for (const double v : values) mean += v / n;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return mean > 0 ? std::sqrt(squares / (n - 1) / n) / mean : 0;
}

// Quantile of a gamma distribution of mean 1 and relative standard deviation `deviation`, for the
// standard normal's `z` (Wilson and Hilferty).
double quantile(double deviation, double z) {
  const double root = 1 - deviation * deviation / 9 + z * deviation / 3;
  return std::pow(std::max(root, 1.0), 3);
}

// The least m 2^j, m < 16, not below n.
uint64_t rounded_up(uint64_t n) {
  const int bits = static_cast<int>(std::bit_width(n));
  if (bits <= 4) return std::max<uint64_t>(n, 1);
  const uint64_t step = uint64_t{1} << (bits - 4);
  return (n + step - 1) / step * step;
}

// Whether that round of the pilot is the last, for a picture of so many samples per pixel.
bool is_enough(const ErrorEstimate& e, uint64_t picture) {
  const uint64_t drawn = kErrorPilotParts * e.samples;
  if (drawn >= (picture + kShare - 1) / kShare)
    return is_reliable(e) || picture > kFewSamples || drawn >= kErrorPilotParts * kFewSamples;
  return e.spread <= kKnown && e.relmse <= kCalm &&
         drawn >= std::min((picture + kShareIfKnown - 1) / kShareIfKnown, kMostIfKnown);
}

}  // namespace

ErrorEstimate estimate_error(const PictureParts& parts, uint64_t samples) {
  ErrorEstimate e;
  e.samples = samples;
  const double mean = mean_magnitude(parts), n = static_cast<double>(parts.size());
  if (!(mean > 0)) return e;
  e.lit = true;
  const double dark = kDark * mean * mean;
  double high = 0, low = 0, squares = 0;
  std::vector<double> of_part(parts.size(), 0);
  for (size_t i = 0; i < parts[0].size(); ++i) {
    double of_pixel = 0;
    for (int c = 0; c < 3; ++c) {
      const PartTerms t = part_terms(parts, i, c, dark);
      high += t.high;
      of_pixel += t.low;
      for (size_t k = 0; k < parts.size(); ++k) {
        const auto x = static_cast<double>(parts[k][i][c]);
        const double off = x - (t.sum - x) / (n - 1);
        of_part[k] += off * off / t.denominator;
      }
    }
    low += of_pixel;
    squares += of_pixel * of_pixel;
  }
  const auto pixels = static_cast<double>(parts[0].size());
  e.relmse = (parts.size() > 2 ? std::sqrt(high * low) : low) / (3 * pixels);
  if (!(low > 0)) return e;
  e.pixels = pixels;
  const double of_pixels = std::sqrt(std::max(0.0, squares / (low * low) - 1 / pixels));
  e.spread = std::max(relative_error(of_part), of_pixels);
  return e;
}

double interval_factor(const ErrorEstimate& estimate) {
  return std::exp(2 * std::min(estimate.spread, 2.0));
}

uint64_t samples_needed(const ErrorEstimate& estimate, uint64_t parts, double target) {
  constexpr double kMost = 0x1p32, kNinetyFive = 1.645;
  constexpr double kMargin = 1.1;  // the estimate may be a tenth too small
  if (!estimate.lit) return 0;
  const double plain = static_cast<double>(estimate.samples) * estimate.relmse / target;
  if (!(plain > 0)) return 1;
  // Variance of the estimate, and of this picture about the mean of such pictures.
  const double known = static_cast<double>(parts * estimate.samples);
  const double variance =
      estimate.spread * estimate.spread * (1 + known / std::max(plain, 1.0)) + 2 / estimate.pixels;
  const double safe = kMargin * plain * quantile(std::min(std::sqrt(variance), 2.0), kNinetyFive);
  return safe >= kMost ? uint64_t{1} << 32 : rounded_up(static_cast<uint64_t>(std::ceil(safe)));
}

void PictureBlocks::add(const std::vector<Vec3d>& sums) {
  if (before_.empty()) before_.resize(sums.size());
  std::vector<Rgb>& block = blocks_.emplace_back();
  block.reserve(sums.size());
  const double share = 1 / static_cast<double>(size_);
  for (size_t i = 0; i < sums.size(); ++i)
    block.emplace_back(Vec3f((sums[i] - before_[i]) * share));
  before_ = sums;
  if (blocks_.size() < 8) return;
  for (size_t b = 0; b < 4; ++b) {
    for (size_t i = 0; i < sums.size(); ++i)
      blocks_[2 * b][i] = (blocks_[2 * b][i] + blocks_[2 * b + 1][i]) * 0.5f;
    if (b > 0) blocks_[b] = std::move(blocks_[2 * b]);
  }
  blocks_.resize(4);
  size_ *= 2;
}

ErrorPilot run_error_pilot(uint64_t pixels, double target, uint64_t most, const DrawPart& draw) {
  PictureParts parts(kErrorPilotParts, std::vector<Rgb>(pixels));
  ErrorPilot pilot;
  for (uint64_t samples = 1, done = 0;; done = samples, samples *= 2) {
    const auto before = static_cast<double>(done), now = static_cast<double>(samples);
    for (uint64_t k = 0; k < kErrorPilotParts; ++k) {
      const auto sums = draw(k, {done, samples - done});
      if (!sums) return pilot;
      for (size_t i = 0; i < pixels; ++i)
        parts[k][i] = Vec3f((Vec3d(parts[k][i]) * before + (*sums)[i]) * (1 / now));
    }
    const ErrorEstimate& estimate = pilot.estimate = estimate_error(parts, samples);
    pilot.needed = samples_needed(estimate, kErrorPilotParts, target);
    const uint64_t drawn = pilot.samples();
    if (estimate.lit) {
      if (drawn * pixels >= kFewestSamples && is_enough(estimate, std::min(pilot.needed, most)))
        return pilot;
    } else if ((drawn >= kDarkEach && drawn * pixels >= kDarkness) || drawn >= most) {
      return pilot;
    }
  }
}

// ---- From the picture itself ----

namespace {

constexpr double kClean = 0.01, kVery = 0.2;  // relMSE that most people call clean, and very noisy
constexpr size_t kMostPixels = 1 << 14, kRun = 64;  // watched; of those compared with neighbours
constexpr int kReach = 2;                           // of the pixels around
constexpr double kNinety = 1.645;                   // standard deviations
// Variance of the estimate less the error of this very picture, over the sum of the pixels'
// squares: that of a normal variable's square and of its estimate from four to seven blocks.
constexpr double kOfSquares = 1.7;
// Relative error of the brightness, and of what stratification gains beyond `low`.
constexpr double kOfModel = 0.15;
// There is an estimate from so many blocks, if the pixels around show the brightness within about
// half of it, and the estimate its error.
constexpr size_t kFewestBlocks = 4;
constexpr double kMostRelmse = 5, kMostSpread = 0.5;

// One pixel's component.
struct PixelTerms {
  double error = 0, difference = 0, denominator = 1;
};

class Watched {
 public:
  Watched(const Film& film, const PictureBlocks& blocks)
      : film_(film), blocks_(blocks), step_(watched_step(film)), sums_(film.sums()) {
    for (const Vec3d& s : sums_)
      for (int c = 0; c < 3; ++c) light_ += std::abs(s[c]);
    light_ /= 3 * static_cast<double>(sums_.size()) * samples();
  }

  size_t count() const { return (sums_.size() + step_ - 1) / step_; }
  bool lit() const { return light_ > 0; }
  std::array<PixelTerms, 3> terms(size_t i) const;

 private:
  double samples() const { return static_cast<double>(film_.samples()); }
  Vec3d variance(size_t i) const;
  Vec3d around(size_t pixel, double& count) const;

  const Film& film_;
  const PictureBlocks& blocks_;
  size_t step_;
  std::vector<Vec3d> sums_;  // of all pixels
  double light_ = 0;         // M
};

// The variance of the mean. The samples since the last block belong to it.
Vec3d Watched::variance(size_t i) const {
  const PictureParts& parts = blocks_.blocks();
  const double size = static_cast<double>(blocks_.size()), all = samples();
  const double rest = all - size * static_cast<double>(parts.size());
  const Vec3d &now = sums_[i * step_], mean = now / all;
  Vec3d squares;
  for (size_t k = 0; k < parts.size(); ++k) {
    const bool last = k + 1 == parts.size();
    const double n = size + (last ? rest : 0);
    const Vec3d sum = Vec3d(parts[k][i]) * size + (last ? now - blocks_.before()[i] : Vec3d());
    const Vec3d off = sum / n - mean;
    for (int c = 0; c < 3; ++c) squares[c] += n * off[c] * off[c];
  }
  return squares / (static_cast<double>(parts.size() - 1) * all);
}

// Mean of the pixels around it.
Vec3d Watched::around(size_t pixel, double& count) const {
  const auto width = static_cast<size_t>(film_.width());
  const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
  Vec3d sum;
  count = 0;
  for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, film_.height() - 1); ++v)
    for (int u = std::max(x - kReach, 0); u <= std::min(x + kReach, film_.width() - 1); ++u) {
      if (u == x && v == y) continue;
      sum += sums_[static_cast<size_t>(v) * width + static_cast<size_t>(u)];
      ++count;
    }
  return sum / (std::max(count, 1.0) * samples());
}

std::array<PixelTerms, 3> Watched::terms(size_t i) const {
  double count = 0;
  const Vec3d mean = sums_[i * step_] / samples(), near = around(i * step_, count),
              error = variance(i);
  std::array<PixelTerms, 3> terms;
  for (int c = 0; c < 3; ++c) {
    PixelTerms& t = terms[static_cast<size_t>(c)];
    const double off = mean[c] - near[c], squared = off * off;
    const double kept = squared > error[c] ? 1 - error[c] / squared : 0;
    const double bright = count > 0 ? near[c] + kept * off : mean[c];
    t.denominator = bright * bright + kDark * light_ * light_;
    t.error = error[c] / t.denominator;
    t.difference = count > 0 ? squared * count / (count + 1) / t.denominator : t.error;
  }
  return terms;
}

}  // namespace

// Pixels that far apart, row by row, come to every column in turn.
size_t watched_step(const Film& film) {
  const auto width = static_cast<size_t>(film.width()), height = static_cast<size_t>(film.height());
  size_t step = (width * height + kMostPixels - 1) / kMostPixels;
  while (std::gcd(step, width) > 1 && step > 1) ++step;
  return step;
}

std::optional<Noise> noise_of(const Film& film, const PictureBlocks& blocks) {
  if (blocks.blocks().size() < kFewestBlocks) return {};
  const Watched watched(film, blocks);
  if (!watched.lit()) return {};
  double high = 0, low = 0, squares = 0;
  for (size_t i = 0; i < watched.count();) {
    double error = 0, difference = 0;  // of a run
    for (const size_t end = std::min(i + kRun, watched.count()); i < end; ++i) {
      double of_pixel = 0;
      for (const PixelTerms& t : watched.terms(i)) {
        of_pixel += t.error;
        difference += t.difference;
      }
      error += of_pixel;
      squares += of_pixel * of_pixel;
    }
    high += error;
    low += std::min(error, difference);
  }
  if (!(high > 0)) return Noise{};
  const double spread = std::sqrt(kOfSquares * squares) / high;
  const double components = 3 * static_cast<double>(watched.count());
  high /= components;
  low /= components;
  if (high > kMostRelmse || spread > kMostSpread) return {};
  const double chance = std::exp(kNinety * std::hypot(spread, kOfModel));
  return Noise{std::sqrt(low * high), low / chance, high * chance};
}

std::string words_of(const Noise& noise) {
  return fmt::format("relMSE {}, {} to {}", number_words(noise.relmse, 2),
                     number_words(noise.low, 2), number_words(noise.high, 2));
}

std::string noise_sentence(const std::optional<Noise>& noise, double seconds) {
  const std::string or_else = "--target-error " + number_words(kClean);
  if (!noise)
    return "how noisy it is cannot be told from so few samples; " + or_else +
           " renders until it is clean";
  if (noise->relmse <= kClean) return "clean (" + words_of(*noise) + ")";
  // As relMSE falls with 1 / samples; powers of two are the best numbers of them.
  const double times = std::exp2(std::max(std::ceil(std::log2(noise->relmse / kClean)), 1.0));
  return fmt::format(
      "{} noisy ({}); for a clean picture: about {:.0f} times as many samples ({} "
      "here), or {}",
      noise->relmse > kVery ? "very" : "still", words_of(*noise), times,
      duration_words(times * seconds), or_else);
}

}  // namespace tdpt
