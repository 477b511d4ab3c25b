#include "tools/tdpt-render/plan/error_pilot.h"

#include <algorithm>

namespace tdpt {
namespace {

// Counts over all pixels. With fewer than kFewest samples small pictures give no estimate; after
// kDarkness samples, and kDarkEach per pixel, without light the pilot stops.
constexpr uint64_t kFewest = uint64_t{1} << 14, kDarkness = uint64_t{1} << 20, kDarkEach = 64;
// A fourth of the picture's samples is enough in any case; an eighth, and at most kMostIfKnown
// samples per pixel, if the estimate is good.
constexpr uint64_t kShare = 4, kShareIfKnown = 8, kMostIfKnown = uint64_t{1} << 15;
constexpr double kKnown = 0.1, kCalm = 0.3;
// Where the picture takes at most that many samples per pixel, a fourth of them may give no
// estimate, and more are cheap.
constexpr uint64_t kFewSamples = 32;

bool is_enough(const ErrorPilot& pilot, uint64_t picture) {
  const uint64_t drawn = ErrorPilot::kParts * pilot.part_samples();
  const ErrorEstimate& e = pilot.rounds.back().estimate;
  if (drawn >= (picture + kShare - 1) / kShare)
    return tells(e) || picture > kFewSamples || drawn >= ErrorPilot::kParts * kFewSamples;
  return e.spread <= kKnown && e.relmse <= kCalm &&
         drawn >= std::min((picture + kShareIfKnown - 1) / kShareIfKnown, kMostIfKnown);
}

}  // namespace

const ErrorPilot::Round& ErrorPilot::about(uint64_t samples) const {
  size_t k = 0;
  while (k + 1 < rounds.size() && (rounds[k + 1].samples <= samples || !tells(rounds[k].estimate)))
    ++k;
  return rounds[k];
}

ErrorPilot run_error_pilot(uint64_t pixels, double target, uint64_t most, const DrawPart& draw) {
  PictureParts parts(ErrorPilot::kParts, std::vector<Rgb>(pixels));
  ErrorPilot pilot;
  for (uint64_t samples = 1, done = 0;; done = samples, samples *= 2) {
    const auto before = static_cast<double>(done), now = static_cast<double>(samples);
    for (uint64_t k = 0; k < ErrorPilot::kParts; ++k) {
      const auto sums = draw(k, {done, samples - done});
      if (!sums) return pilot;
      for (size_t i = 0; i < pixels; ++i)
        parts[k][i] = Vec3f((Vec3d(parts[k][i]) * before + (*sums)[i]) * (1 / now));
    }
    const ErrorEstimate& estimate =
        pilot.rounds.emplace_back(ErrorPilot::Round{samples, estimate_error(parts)}).estimate;
    const uint64_t drawn = ErrorPilot::kParts * samples;
    if (estimate.lit) {
      pilot.needed = samples_needed(estimate, ErrorPilot::kParts, samples, target);
      if (drawn * pixels >= kFewest && is_enough(pilot, std::min(pilot.needed, most))) return pilot;
    } else if ((drawn >= kDarkEach && drawn * pixels >= kDarkness) || drawn >= most) {
      return pilot;
    }
  }
}

ErrorPilot run_error_pilot(SampleRenderer& renderer, const Integrator& integrator,
                           const SampleRules& rules, double target, uint64_t most,
                           const std::function<bool()>& give_up, Film& film, ProgressBar& progress) {
  Tally tally(film.unit());
  const auto pixels = static_cast<uint64_t>(film.width()) * static_cast<uint64_t>(film.height());
  const DrawPart draw = [&](uint64_t part,
                            const SampleRange& samples) -> std::optional<std::vector<Vec3d>> {
    if (give_up()) return {};
    film.clear();
    renderer.render(integrator, rules, kErrorPilotRounds.first + part, samples, film, tally,
                    progress);
    return film.sums();
  };
  const ErrorPilot pilot = run_error_pilot(pixels, target, most, draw);
  film.clear();
  return pilot;
}

}  // namespace tdpt
