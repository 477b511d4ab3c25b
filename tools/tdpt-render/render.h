// The loop over pixels and samples.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "tools/tdpt-render/beyond.h"
#include "tools/tdpt-render/error_estimate.h"
#include "tools/tdpt-render/passes.h"
#include "tools/tdpt-render/plan.h"
#include "tools/tdpt-render/scout.h"

namespace tdpt {

struct RenderSettings {
  uint64_t spp = 0;    ///< samples per pixel; 0: as many as fit into `seconds`, or the target takes
  double seconds = 0;  ///< wall-clock limit of rendering alone; 0: none
  /// relMSE to render to, within the limits of spp and seconds; 0: none, they are what is rendered.
  double target_error = 0;
  bool retry = false;  ///< where it is missed, goes on once
  int max_depth = kMaxDepth;
  double beta = 1;  ///< 1: balance heuristic, 2: power heuristic
  uint64_t seed = 1;
  bool quiet = true;
  bool alpha = false;   ///< transparent film: the sky behind all is left out
  bool layers = false;  ///< keep each technique's contribution apart
  bool frames = false;  ///< measure the picture while it forms
};

/// How many samples per pixel there will be, as far as the settings say; 0: as time allows.
uint64_t spp_foreseen(const RenderSettings& settings);

Vec3d mean_of(const Picture& picture);      ///< over all pixels
double nonzero_of(const Picture& picture);  ///< share of pixels that are not black

/// The picture after its first `spp` samples per pixel.
struct FrameRecord {
  uint64_t spp = 0;
  double nonzero = 0;                   ///< share of pixels that are not black
  Vec3d mean;                           ///< over all pixels
  double seconds = 0, cpu_seconds = 0;  ///< of rendering until then
};

/// The first number of samples above `spp` that gets a record: each until 256, then each that is a
/// sixteenth more than the one before.
uint64_t next_frame(uint64_t spp);

/// How a picture that was to have a relMSE of at most `error` came out.
struct TargetOutcome {
  /// `fixed`: all samples are there that were fixed; `unlit`: none were, the pilot met no light.
  enum class Stop { fixed, spp, time, signal, unlit };

  double error = 0;
  uint64_t pilot_samples = 0;  ///< of each pixel, thrown away
  double pilot_cpu_seconds = 0;
  uint64_t fixed = 0;  ///< samples of each pixel, by the pilot; 0: it did not come to that
  bool retried = false;
  bool may_retry = false;  ///< --retry was not asked for
  Stop stop = Stop::fixed;
  bool dark = false;             ///< nothing in the scene emits light: there is no error
  std::optional<double> relmse;  ///< of the picture, estimated; from no light nothing is told
  double low = 0, high = 0;      ///< its interval, about 95 %
  bool reached() const { return dark || (relmse && *relmse <= error); }
};

struct RenderResult {
  Picture picture;                      ///< with its alpha where the settings ask for it
  uint64_t spp = 0;                     ///< samples each pixel got
  double seconds = 0, cpu_seconds = 0;  ///< the scout's counted, measuring frames not
  bool interrupted = false;  ///< a signal ended it early; the picture holds what was there
  Plan plan;                 ///< what was decided by measuring
  RenderTally tally;
  std::map<std::string, Picture> layers;  ///< by technique; they add up to the picture
  std::vector<FrameRecord> frames;        ///< the last one is the picture

  std::optional<TargetOutcome> target;  ///< where the settings have one
  std::optional<Beyond> beyond;         ///< what the limit of depth leaves out, where there is one

  std::optional<int> longest;       ///< path worth sampling, if shorter than asked [longest_path.h]
  size_t chosen = 0;                ///< which of the candidates rendered
  std::string chosen_label;         ///< empty when there was only one
  std::vector<Prospect> prospects;  ///< of the candidates; empty where none was looked at
  uint64_t scouted = 0;             ///< samples that they are told from
  double scout_cpu_seconds = 0;

  Vec3d mean() const { return mean_of(picture); }
  double nonzero() const { return nonzero_of(picture); }
};

/// Renders in passes over the whole picture, so every pixel has the same number of samples whenever
/// it stops. The picture is a function of (scene, settings, spp) alone.
RenderResult render(const World& world, const Integrator& integrator,
                    const RenderSettings& settings);

/// Renders with the best of the candidates, found by a scout if the budget allows one [scout.h],
/// else with the first. `ways`: how the portals of `world` were turned before, for the plan.
RenderResult render(const World& world, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings, const std::vector<PortalWay>& ways = {});

}  // namespace tdpt
