#include "tools/tdpt-render/plan/noise.h"

#include <bit>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "libcommon/base/number_words.h"

namespace tdpt {
namespace {

constexpr double kClean = 0.01, kVery = 0.2;  // relMSE that most people call clean, and very noisy

// Pixels that far apart, row by row, come to every column in turn.
size_t step_of(const Film& film) {
  const auto width = static_cast<size_t>(film.width()), height = static_cast<size_t>(film.height());
  size_t step = (width * height + NoiseWatch::kMostPixels - 1) / NoiseWatch::kMostPixels;
  while (std::gcd(step, width) > 1 && step > 1) ++step;
  return step;
}

}  // namespace

std::string words_of(const Noise& noise) {
  if (!noise.tells)
    return fmt::format("relMSE above {}, too large to tell from so few samples",
                       number_words(std::min(noise.low, 0.5), 2));
  return fmt::format("relMSE about {} [{}, {}]", number_words(noise.relmse, 2),
                     number_words(noise.low, 2), number_words(noise.high, 2));
}

std::string noise_sentence(const Noise& noise, double seconds) {
  // As relMSE falls with 1 / samples; powers of two are the best numbers of them.
  const auto times = [&](double relmse) {
    const double more = std::exp2(std::ceil(std::log2(relmse / kClean)));
    return fmt::format("{:.0f} times as many samples ({}), or --target-error {}", more,
                       duration_words(more * seconds) + " here", number_words(kClean));
  };
  if (!noise.tells) {
    const double least = std::min(noise.low, 0.5);
    if (least <= kClean) return "noise not known yet (relMSE above " + number_words(least, 2) + ")";
    return fmt::format("{} noisy (relMSE above {}); for a clean picture: at least {}",
                       least > kVery ? "very" : "still", number_words(least, 2), times(least));
  }
  const std::string relmse = fmt::format("relMSE {}, {} to {}", number_words(noise.relmse, 2),
                                         number_words(noise.low, 2), number_words(noise.high, 2));
  if (noise.relmse <= kClean) return "clean (" + relmse + ")";
  return fmt::format("still noisy ({}); for a clean picture: about {}", relmse,
                     times(noise.relmse));
}

NoiseWatch::NoiseWatch(const Film& film, uint64_t samples)
    : step_(step_of(film)), from_(film.samples()) {
  const uint64_t block = std::bit_floor(std::max<uint64_t>(samples / 4, 1));
  if (from_ > 0 || block > 1)
    blocks_ = PictureBlocks(block, {}, from_ > 0 ? film.sums(step_) : std::vector<Vec3d>());
}

std::optional<Noise> NoiseWatch::noise(const Film& film) const {
  if (blocks_.blocks().size() < 4) return {};
  const ErrorEstimate estimate = estimate_error(blocks_.blocks());
  if (!estimate.lit) return {};
  Noise noise;
  noise.relmse =
      estimate.relmse * static_cast<double>(blocks_.size()) / static_cast<double>(film.samples());
  noise.low = noise.relmse / interval_factor(estimate);
  noise.high = noise.relmse * interval_factor(estimate);
  // With four blocks, of which two tell how bright a pixel is, it is then up to a fifth too large.
  noise.tells = estimate.relmse <= 0.2;
  return noise;
}

}  // namespace tdpt
