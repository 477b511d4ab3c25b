#include "tools/tdpt-render/plan/sample_count.h"

#include <algorithm>
#include <bit>

#include "libcommon/base/signals.h"
#include "libcommon/math/streams.h"

namespace tdpt {
namespace {

// Number of samples that fit into the time, by the speed of trial samples that are thrown away,
// doubled until they take long enough. Of the form m 2^j, m < 16, as in samples_needed().
uint64_t samples_in_time(Session& session, const Integrator& integrator, const Film& film) {
  constexpr double kShare = 0.02;
  const double seconds = session.settings.seconds;
  if (session.longest == 0) return 1;
  session.make_ready(integrator, film);
  Progress progress("measuring the time", "samples", 0, session.settings.quiet);
  Film aside = session.film_aside();
  Tally tally(aside.unit());
  double each = 0;
  for (uint64_t n = 1, done = 0; !stop_requested(); done += n, n *= 2) {
    const double before = session.clock.seconds();
    session.renderer.render(integrator, session.rules, kTimingRound.first, {done, n}, aside, tally,
                            progress);
    const double took = session.clock.seconds() - before;
    each = took / static_cast<double>(n);
    if (took > kShare * seconds) break;
  }
  if (!(each > 0)) return 1;  // a signal came first
  const double left = std::max(seconds - session.clock.seconds(), 0.0);
  auto samples = static_cast<uint64_t>(std::clamp(left / each, 1.0, 0x1p32));
  while (static_cast<int>(std::bit_width(samples)) > std::countr_zero(samples) + 4)
    samples &= samples - 1;
  return samples;
}

ErrorPilot piloted(const Session& session, const Integrator& integrator) {
  const RenderSettings& settings = session.settings;
  const auto give_up = [&] {
    const bool late = settings.seconds > 0 && session.clock.seconds() > 0.5 * settings.seconds;
    return late || stop_requested();
  };
  Film aside = session.film_aside();
  Progress progress("measuring the error", "samples", 0, settings.quiet);
  const uint64_t most = settings.spp > 0 ? settings.spp : kMostSamples;
  return run_error_pilot(session.renderer, integrator, session.rules, settings.target_error, most,
                         give_up, aside, progress);
}

void aim_at_error(Session& session, const Integrator& integrator, const Film& film,
                  SampleCount& count) {
  const RenderSettings& settings = session.settings;
  TargetOutcome& target = count.target_at_start.emplace();
  target.error = settings.target_error;
  target.dark = session.longest == 0 || session.world.lights.empty();
  target.may_retry = !settings.retry;
  if (target.dark) {
    if (settings.spp == 0) count.goal = settings.alpha ? 16 : 1;
    target.fixed = count.goal;
    return;
  }
  session.make_ready(integrator, film);
  const double cpu = session.clock.cpu();
  count.pilot = piloted(session, integrator);
  const ErrorPilot& pilot = count.pilot;
  target.pilot_samples = ErrorPilot::kParts * pilot.part_samples();
  target.pilot_cpu_seconds = session.clock.cpu() - cpu;
  target.fixed = pilot.needed;
  // Where the pilot met no light the picture gets as many samples as it: they may.
  uint64_t goal = pilot.needed > 0 ? pilot.needed : target.pilot_samples;
  if (settings.spp > 0) goal = goal > 0 ? std::min(goal, settings.spp) : settings.spp;
  if (goal == 0 && settings.seconds == 0) goal = kMostSamples;  // a signal will end it
  count.goal = goal;
  count.measured = true;
}

// Blocks of that many samples are trusted more than a pilot in any case.
constexpr uint64_t kTelling = 8;

ErrorEstimate estimate_of(const PictureBlocks& blocks) {
  return blocks.blocks().size() > 2 ? estimate_error(blocks.blocks()) : ErrorEstimate{};
}

TargetOutcome::Stop stop_of(const RenderSettings& settings, const TargetProgress& at,
                            const TargetOutcome& target) {
  using Stop = TargetOutcome::Stop;
  if (at.interrupted) return Stop::signal;
  if (at.goal == 0 || at.samples < at.goal) return Stop::time;
  if (at.goal == settings.spp && target.fixed != at.goal) return Stop::spp;
  return target.fixed > 0 ? Stop::fixed : Stop::unlit;
}

}  // namespace

uint64_t spp_foreseen(const RenderSettings& settings) {
  constexpr uint64_t kOfTarget = 64;
  if (settings.target_error == 0) return settings.spp;
  return settings.spp > 0 ? std::min(settings.spp, kOfTarget) : kOfTarget;
}

double samples_foreseen(const RenderSettings& settings, const FilmPlane& film) {
  constexpr double kPerSecond = 2e5;
  const uint64_t spp = spp_foreseen(settings);
  if (spp == 0) return kPerSecond * settings.seconds;
  return static_cast<double>(spp) * film.width() * film.height();
}

SampleCount count_samples(Session& session, const Integrator& integrator, const Film& film) {
  const RenderSettings& settings = session.settings;
  SampleCount count;
  count.goal = settings.spp;
  if (settings.target_error > 0) aim_at_error(session, integrator, film, count);
  const bool dark = count.target_at_start && count.target_at_start->dark;
  if (!settings.fixed || settings.seconds == 0 || dark) return count;
  const uint64_t most = samples_in_time(session, integrator, film);
  count.goal = count.goal > 0 ? std::min(count.goal, most) : most;
  count.measured = true;
  return count;
}

// The picture's noise; where that is not told, what its blocks show, or the pilot's parts, if the
// blocks' estimate does not suffice or there are fewer than three.
void judge(const RenderSettings& settings, const TargetProgress& at, TargetOutcome& target) {
  target.stop = stop_of(settings, at, target);
  target.relmse.reset();
  std::optional<Noise> noise = at.noise;
  ErrorEstimate estimate = estimate_of(at.blocks);
  uint64_t of = at.blocks.size();
  if (!tells(estimate) && of < kTelling && !at.pilot.rounds.empty()) {
    const ErrorPilot::Round& round = at.pilot.about(at.samples);
    if (round.estimate.lit && (tells(round.estimate) || round.samples > of || !estimate.lit))
      estimate = round.estimate, of = round.samples;
  }
  if (!noise && estimate.lit) {
    const double relmse =
        estimate.relmse * static_cast<double>(of) / static_cast<double>(at.samples);
    const double factor = interval_factor(estimate);
    noise = {relmse, relmse / factor, relmse * factor};
  }
  if (!noise) return;
  target.relmse = noise->relmse;
  target.low = noise->low;
  target.high = noise->high;
}

std::optional<uint64_t> goal_of_retry(const RenderSettings& settings, const TargetProgress& at,
                                      TargetOutcome& target) {
  if (!settings.retry || target.retried) return {};
  const ErrorEstimate estimate = estimate_of(at.blocks);
  const bool known = tells(estimate) || (estimate.lit && at.blocks.size() >= kTelling);
  if (target.stop != TargetOutcome::Stop::fixed || target.reached() || !known) return {};
  const uint64_t needed =
      samples_needed(estimate, at.blocks.blocks().size(), at.blocks.size(), target.error);
  const uint64_t goal = settings.spp > 0 ? std::min(needed, settings.spp) : needed;
  if (goal <= at.samples) {
    if (needed > goal) target.stop = TargetOutcome::Stop::spp;
    return {};
  }
  target.fixed = needed;
  target.retried = true;
  return goal;
}

}  // namespace tdpt
