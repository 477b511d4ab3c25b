// The loop over pixels and samples.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/tdpt-render/integrators/sample_renderer.h"
#include "tools/tdpt-render/plan/beyond.h"
#include "tools/tdpt-render/plan/noise.h"
#include "tools/tdpt-render/plan/plan.h"
#include "tools/tdpt-render/plan/scout.h"
#include "tools/tdpt-render/run/standing.h"

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
  bool alpha = false;     ///< transparent film: the sky behind all is left out
  bool layers = false;    ///< keep each technique's contribution apart
  bool variance = false;  ///< keep what tells the variance of each pixel
  bool frames = false;    ///< measure the picture while it forms
  /// A limit of time is turned into a number of samples before the first one.
  bool fixed = false;
  std::shared_ptr<SampleRenderer> device;  ///< renders, and what it takes to plan; none: the CPU
  std::string device_name = "cpu";
  Limits limits() const { return {spp, seconds, target_error, retry}; }
};

/// What the film of such a rendering keeps.
Film::Options film_options(const World& world, const std::vector<Candidate>& candidates,
                           const RenderSettings& settings);

/// What a rendering obeys, goes on from, or is a part of.
struct Course {
  std::optional<Plan> plan;          ///< to obey; none: it is decided
  std::optional<Standing> standing;  ///< to go on from, by a plan
  /// Samples of the plan's that are to be rendered; count 0: all.
  SampleRange part{};
  uint64_t whole = 0;  ///< samples of the whole picture then
  /// Looks at what there is, about every so many seconds between passes over the picture, but not
  /// for more than a tenth of the time; not counted as rendering.
  struct Visitor {
    double every;  ///< seconds
    std::function<void(Standing&, const Plan&)> visit;
  };
  std::vector<Visitor> visitors{};
  /// Where the renderer fails with an Error, keeps what there is.
  std::function<void(Standing&, const Plan&)> rescue{};
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

struct RenderResult {
  Picture picture;                      ///< with its alpha where the settings ask for it
  uint64_t spp = 0;                     ///< samples each pixel got
  double seconds = 0, cpu_seconds = 0;  ///< the scout's counted, measuring frames not
  bool interrupted = false;  ///< a signal ended it early; the picture holds what was there
  Plan plan;                 ///< what was decided by measuring
  bool hasty = false;        ///< a signal came before it was: another run would decide otherwise
  std::shared_ptr<Standing> standing;  ///< where it ended
  RenderTally tally;
  std::map<std::string, Picture> layers;  ///< by technique; they add up to the picture
  std::vector<FrameRecord> frames;        ///< the last one is the picture

  std::optional<TargetOutcome> target;  ///< where the settings have one
  std::optional<Noise> noise;           ///< where they have none, as far as it can be told
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
                    const RenderSettings& settings, const std::vector<PortalWay>& ways = {},
                    Course course = {});

/// All that the same call would decide before its first sample, and by what: a result without one.
RenderResult decide(const World& world, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings, const std::vector<PortalWay>& ways);

}  // namespace tdpt
