#include "tools/tdpt-render/run/target.h"

#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/words.h"

namespace tdpt {
namespace {

using Stop = TargetOutcome::Stop;

// Indexed by Stop.
constexpr std::array kStops{"target", "spp", "time", "signal", "no light"};

// Blocks of that many samples are trusted more than a pilot in any case.
constexpr uint64_t kTelling = 8;

const char* stop_of(const TargetOutcome& target) {
  return kStops[static_cast<size_t>(target.stop)];
}

ErrorEstimate estimate_of(const PictureBlocks& blocks) {
  return blocks.blocks().size() > 2 ? estimate_error(blocks.blocks(), blocks.size())
                                    : ErrorEstimate{.samples = blocks.size()};
}

Stop stop_of(const Progress& progress, uint64_t fixed) {
  const uint64_t samples = progress.film.samples();
  if (progress.interrupted) return Stop::signal;
  if (progress.goal == 0 || samples < progress.goal) return Stop::time;
  if (progress.goal == progress.in_force().spp && fixed != progress.goal) return Stop::spp;
  return fixed > 0 ? Stop::fixed : Stop::unlit;
}

// What the picture's blocks show, or the pilot's parts, if the blocks' estimate does not suffice or
// there are fewer than three.
std::optional<Noise> noise_of_parts(const std::vector<ErrorEstimate>& rounds,
                                    const Progress& progress) {
  const uint64_t samples = progress.film.samples();
  ErrorEstimate estimate = estimate_of(progress.blocks);
  if (!tells(estimate) && estimate.samples < kTelling && !rounds.empty()) {
    const ErrorEstimate& round = best_round(rounds, samples);
    if (round.lit && (tells(round) || round.samples > estimate.samples || !estimate.lit))
      estimate = round;
  }
  if (!estimate.lit) return {};
  const double relmse =
      estimate.relmse * static_cast<double>(estimate.samples) / static_cast<double>(samples);
  const double factor = interval_factor(estimate);
  return Noise{relmse, relmse / factor, relmse * factor};
}

// "about 0.0093 [0.0088, 0.0098]".
std::string estimate_of(const TargetOutcome& target) {
  if (!target.noise) return "not known";
  return fmt::format("about {} [{}, {}]", number_words(target.noise->relmse, 2),
                     number_words(target.noise->low, 2), number_words(target.noise->high, 2));
}

}  // namespace

std::optional<TargetOutcome> judge(const Session& session, const Plan& plan,
                                   const Progress& progress, const std::optional<Noise>& noise) {
  TargetOutcome target;
  target.error = progress.in_force().target_error;
  if (target.error == 0) return {};
  target.dark = session.is_dark();
  target.fixed = target.dark            ? plan.spp
                 : progress.retried > 0 ? progress.retried
                                        : plan.needed;
  target.stop = stop_of(progress, target.fixed);
  target.noise = noise ? noise : noise_of_parts(plan.error_rounds, progress);
  return target;
}

bool raise_goal(TargetOutcome& target, Progress& progress) {
  const Limits& limits = progress.limits;
  if (!limits.retry || progress.retried > 0) return false;
  const PictureBlocks& blocks = progress.blocks;
  const ErrorEstimate estimate = estimate_of(blocks);
  const bool known = tells(estimate) || (estimate.lit && blocks.size() >= kTelling);
  if (target.stop != Stop::fixed || target.reached() || !known) return false;
  const uint64_t needed = samples_needed(estimate, blocks.blocks().size(), target.error);
  const uint64_t goal = limits.spp > 0 ? std::min(needed, limits.spp) : needed;
  if (goal <= progress.film.samples()) {
    if (needed > goal) target.stop = Stop::spp;
    return false;
  }
  progress.retried = needed;
  progress.goal = goal;
  return true;
}

std::string target_sentence(const TargetOutcome& target, const Progress& progress) {
  const std::string aim = fmt::format("target relMSE {} ", number_words(target.error));
  if (target.dark) return aim + "reached: no light can come to the camera, the picture is black";
  const std::string got =
      fmt::format(": it is {} after {} per pixel{}", estimate_of(target),
                  counted(progress.film.samples(), "sample"),
                  progress.retried > 0 ? ", those of --set retry=1 among them" : "");
  if (target.reached()) return aim + "reached" + got;
  const std::string enough =
      target.fixed > 0 ? fmt::format("; {} would do", target.fixed) : std::string();
  switch (target.stop) {
    case Stop::spp:
      return aim + "not reached, stopped by --spp" + got + enough;
    case Stop::time:
      return aim + "not reached, stopped by --time" + got + enough;
    case Stop::signal:
      return aim + "not reached, stopped by a signal" + got + enough;
    case Stop::unlit:
      return aim + "not reached, too little light was met to tell how many samples it takes" + got;
    case Stop::fixed:
      break;
  }
  return aim + "missed" + got + (!progress.limits.retry ? "; --set retry=1 renders on" : "");
}

nlohmann::ordered_json target_json(const TargetOutcome& target, const Plan& plan,
                                   const Progress& progress) {
  nlohmann::ordered_json j{{"error", target.error},
                           {"reached", target.reached()},
                           {"stopped_by", stop_of(target)},
                           {"relmse", nullptr},
                           {"interval", nullptr}};
  if (target.dark) j["relmse"] = 0;
  if (target.noise) {
    j["relmse"] = target.noise->relmse;
    j["interval"] = {target.noise->low, target.noise->high};
  }
  j["fixed_spp"] = nullptr;
  if (target.fixed > 0) j["fixed_spp"] = target.fixed;
  j["retried"] = progress.retried > 0;
  j["pilot"] = {{"spp", plan.error_pilot_samples()}, {"cpu", plan.error_pilot_cpu_seconds}};
  return j;
}

std::map<std::string, std::string> target_attributes(const TargetOutcome& target) {
  return {{"targetError", fmt::format("{:.6g}", target.error)},
          {"estimatedError", target.dark ? "0" : estimate_of(target)},
          {"stoppedBy", stop_of(target)}};
}

}  // namespace tdpt
