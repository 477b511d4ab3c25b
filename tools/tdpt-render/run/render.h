// Renders a picture: decides, then loops over pixels and samples.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/tdpt-render/plan/decision.h"
#include "tools/tdpt-render/plan/noise.h"
#include "tools/tdpt-render/run/render_state.h"

namespace tdpt {

/// What the film of such a rendering keeps.
Film::Options film_options(const World& world, const std::vector<Candidate>& candidates,
                           const RenderSettings& settings);

/// What a rendering obeys, goes on from, or is a part of.
struct RenderSchedule {
  std::optional<Plan> plan;                 ///< to obey; none: it is decided
  std::optional<RenderState> render_state;  ///< to go on from, by a plan
  /// Samples of the plan's that are to be rendered; count 0: all.
  SampleRange part{};
  uint64_t whole = 0;  ///< samples of the whole picture then
  /// Looks at what there is, about every so many seconds between passes over the picture, but not
  /// for more than a tenth of the time; not counted as rendering.
  struct Visitor {
    double every;  ///< seconds
    std::function<void(RenderState&, const Plan&)> visit;
  };
  std::vector<Visitor> visitors{};
  /// Where the renderer fails with an Error, keeps what there is.
  std::function<void(RenderState&, const Plan&)> rescue{};
};

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

struct RenderResult : Decision {
  Picture picture;                      ///< with its alpha where the settings ask for it
  std::string renderer;                 ///< its name
  uint64_t spp = 0;                     ///< samples each pixel got
  double seconds = 0, cpu_seconds = 0;  ///< the pilot's counted, measuring frames not
  bool interrupted = false;  ///< a signal ended it early; the picture holds what was there
  std::shared_ptr<RenderState> render_state;  ///< where it ended
  RenderTally tally;
  std::map<std::string, Picture> layers;  ///< by technique; they add up to the picture
  std::vector<FrameRecord> frames;        ///< the last one is the picture

  std::optional<TargetOutcome> target;  ///< as it came out, where the settings have one
  std::optional<Noise> noise;           ///< where they have none, as far as it can be told

  Vec3d mean() const { return mean_of(picture); }
  double nonzero() const { return nonzero_of(picture); }
};

/// Renders with the best of the candidates [decision.h], in passes over the whole picture, so every
/// pixel has the same number of samples whenever it stops. The picture is a function of (scene,
/// settings, plan, spp) alone.
RenderResult render(SampleRenderer& renderer, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings, const Known& known = {},
                    RenderSchedule schedule = {});
RenderResult render(SampleRenderer& renderer, const Integrator& integrator,
                    const RenderSettings& settings);
/// By the CPU.
RenderResult render(const World& world, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings);
RenderResult render(const World& world, const Integrator& integrator,
                    const RenderSettings& settings);

/// All that the same call would decide before its first sample, and by what: a result without one.
RenderResult decide(SampleRenderer& renderer, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings, const Known& known);

}  // namespace tdpt
