#include "tools/tdpt-render/plan/noise.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "libcommon/base/words.h"

namespace tdpt {
namespace {

constexpr double kClean = 0.01, kVery = 0.2;  // relMSE that most people call clean, and very noisy
constexpr double kDark = 0.01;                // as exrdiff's relMSE
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
struct Terms {
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
  std::array<Terms, 3> terms(size_t i) const;

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

std::array<Terms, 3> Watched::terms(size_t i) const {
  double count = 0;
  const Vec3d mean = sums_[i * step_] / samples(), near = around(i * step_, count),
              error = variance(i);
  std::array<Terms, 3> terms;
  for (int c = 0; c < 3; ++c) {
    Terms& t = terms[static_cast<size_t>(c)];
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
      for (const Terms& t : watched.terms(i)) {
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
