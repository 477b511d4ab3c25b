// How many samples each pixel gets: a given number, as many as the time allows, or as many as a
// target error needs; and whether there is a second try.
#pragma once
#include <optional>

#include "tools/tdpt-render/plan/error_pilot.h"
#include "tools/tdpt-render/plan/noise.h"
#include "tools/tdpt-render/plan/session.h"

namespace tdpt {

/// Largest number per pixel, as for --spp.
inline constexpr uint64_t kMostSamples = uint64_t{1} << 32;

/// Per pixel, by the settings alone, before anything is measured; 0: as time allows.
uint64_t spp_foreseen(const RenderSettings& settings);
/// Of the whole picture, approximately; under a time limit, at the speed of a typical scene.
double samples_foreseen(const RenderSettings& settings, const FilmPlane& film);

/// Result of a picture with a target relMSE of `error`.
struct TargetOutcome {
  /// `fixed`: the fixed number was rendered; `unlit`: the pilot met no light and fixed none.
  enum class Stop { fixed, spp, time, signal, unlit };

  double error = 0;
  uint64_t pilot_samples = 0;  ///< per pixel, thrown away
  double pilot_cpu_seconds = 0;
  uint64_t fixed = 0;  ///< samples per pixel, fixed by the pilot; 0: none
  bool retried = false;
  bool may_retry = false;  ///< --set retry was not asked for
  Stop stop = Stop::fixed;
  bool dark = false;             ///< nothing in the scene emits light: there is no error
  std::optional<double> relmse;  ///< of the picture, estimated; none if no light was met
  double low = 0, high = 0;      ///< its interval, 90 %
  bool reached() const { return dark || (relmse && *relmse <= error); }
};

struct SampleCount {
  uint64_t goal = 0;      ///< samples per pixel; 0: as many as the time allows
  bool measured = false;  ///< rather than asked for
  std::optional<TargetOutcome> target_at_start;  ///< if an error is asked for
  ErrorPilot pilot;
};
/// Called before the first sample of the picture. For a target error, or a time limit that is to
/// become a fixed number, it draws samples that are thrown away.
SampleCount count_samples(Session& session, const Integrator& integrator, const Film& film);

/// State of a picture with a target.
struct TargetProgress {
  uint64_t samples, goal;  ///< per pixel: rendered, and asked for
  bool interrupted;        ///< by a signal
  const PictureBlocks& blocks;
  const ErrorPilot& pilot;
  std::optional<Noise> noise;
};
/// Takes over the picture's noise, or where that is not known what the pilot predicts, and sets
/// what ended the rendering.
void judge(const RenderSettings& settings, const TargetProgress& at, TargetOutcome& target);
/// The new goal if a second try is due. The samples rendered so far are kept.
std::optional<uint64_t> goal_of_retry(const RenderSettings& settings, const TargetProgress& at,
                                      TargetOutcome& target);

}  // namespace tdpt
