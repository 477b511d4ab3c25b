// How many samples each pixel gets: as the settings say, as the time allows, or as the error takes
// that is asked for, and whether there is a second try.
#pragma once
#include <optional>

#include "tools/tdpt-render/plan/error_pilot.h"
#include "tools/tdpt-render/plan/session.h"

namespace tdpt {

/// Of each pixel at the most, as --spp.
inline constexpr uint64_t kMostSamples = uint64_t{1} << 32;

/// As far as the settings say, before anything is known; 0: as time allows.
uint64_t spp_foreseen(const RenderSettings& settings);
/// Samples of the whole picture, about; by the clock, as fast as most scenes are.
double samples_foreseen(const RenderSettings& settings, const FilmPlane& film);

/// How a picture that was to have a relMSE of at most `error` came out.
struct TargetOutcome {
  /// `fixed`: all samples are there that were fixed; `unlit`: none were, the pilot met no light.
  enum class Stop { fixed, spp, time, signal, unlit };

  double error = 0;
  uint64_t pilot_samples = 0;  ///< of each pixel, thrown away
  double pilot_cpu_seconds = 0;
  uint64_t fixed = 0;  ///< samples of each pixel, by the pilot; 0: it did not come to that
  bool retried = false;
  bool may_retry = false;  ///< --set retry was not asked for
  Stop stop = Stop::fixed;
  bool dark = false;             ///< nothing in the scene emits light: there is no error
  std::optional<double> relmse;  ///< of the picture, estimated; from no light nothing is told
  double low = 0, high = 0;      ///< its interval, about 95 %
  bool reached() const { return dark || (relmse && *relmse <= error); }
};

struct SampleCount {
  uint64_t goal = 0;      ///< samples of each pixel; 0: as many as the time allows
  bool measured = false;  ///< rather than asked for
  std::optional<TargetOutcome> target_at_start;  ///< where an error is asked for
  ErrorPilot pilot;
};
/// Before the first sample of the picture. Where an error is asked for, or a time that is to be
/// fixed, by samples that are thrown away.
SampleCount count_samples(Session& session, const Integrator& integrator, const Film& film);

/// Where a picture with a target stands.
struct TargetProgress {
  uint64_t samples, goal;  ///< of each pixel: there, and asked for
  bool interrupted;        ///< by a signal
  const PictureBlocks& blocks;
  const ErrorPilot& pilot;
};
/// Says what the picture's own blocks tell of its error, and what ended it.
void judge(const RenderSettings& settings, const TargetProgress& at, TargetOutcome& target);
/// The new goal where a second try is due. The samples that are there stay.
std::optional<uint64_t> goal_of_retry(const RenderSettings& settings, const TargetProgress& at,
                                      TargetOutcome& target);

}  // namespace tdpt
