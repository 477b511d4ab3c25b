// Renders a picture: decides, then loops over passes of samples.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/tdpt-render/plan/decision.h"
#include "tools/tdpt-render/run/render_state.h"

namespace tdpt {

/// The sums that the film of such a rendering keeps.
Film::Options film_options(const std::vector<Candidate>& candidates,
                           const RenderSettings& settings);

/// What a rendering obeys, resumes, or is a part of.
struct RenderSchedule {
  std::optional<Plan> plan;                 ///< to obey; none: it is decided
  std::optional<RenderState> render_state;  ///< to resume, by a plan
  /// The plan's samples to render; count 0: all.
  SampleRange part{};
  uint64_t whole = 0;  ///< samples of the whole picture if this is a part
  /// Called between passes over the picture about every so many seconds, for at most a tenth of the
  /// time; not counted as rendering.
  struct Visitor {
    double every;  ///< seconds
    std::function<void(RenderState&, const Plan&)> visit;
  };
  std::vector<Visitor> visitors{};
  /// Called if the renderer fails with an Error, to save what has been rendered.
  std::function<void(RenderState&, const Plan&)> rescue{};
};

Vec3d mean_of(const Picture& picture);      ///< over all pixels
double nonzero_of(const Picture& picture);  ///< share of pixels that are not black

/// The next number of samples above `spp` that is recorded: each up to 256, then each a sixteenth
/// more than the one before.
uint64_t next_frame(uint64_t spp);

struct RenderResult : Decision {
  Picture picture;                      ///< with its alpha if the settings ask for it
  std::string renderer;                 ///< its name
  uint64_t spp = 0;                     ///< samples per pixel
  double seconds = 0, cpu_seconds = 0;  ///< with the pilot, without measuring frames
  bool interrupted = false;  ///< a signal ended it early; the picture has the samples until then
  std::shared_ptr<RenderState> render_state;  ///< at the end
  RenderTally tally;
  std::map<std::string, Picture> layers;  ///< by technique; their sum is the picture
  std::vector<FrameRecord> frames;        ///< the last one is the picture

  std::optional<TargetOutcome> target;  ///< its outcome, if the settings have one
  std::optional<Noise> noise;           ///< of the picture, if it is known

  Vec3d mean() const { return mean_of(picture); }
  double nonzero() const { return nonzero_of(picture); }
};

/// Renders with the best of the candidates [decision.h], in passes over the whole picture, so that
/// all pixels have equally many samples whenever it stops. The picture is a function of (scene,
/// settings, plan, spp) alone.
RenderResult render(SampleRenderer& renderer, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings, const Known& known = {},
                    RenderSchedule schedule = {});
RenderResult render(SampleRenderer& renderer, const Integrator& integrator,
                    const RenderSettings& settings);
/// On the CPU.
RenderResult render(const World& world, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings);
RenderResult render(const World& world, const Integrator& integrator,
                    const RenderSettings& settings);

/// Everything the same call would decide before its first sample: a result without a picture.
RenderResult decide(SampleRenderer& renderer, const std::vector<Candidate>& candidates,
                    const RenderSettings& settings, const Known& known);

}  // namespace tdpt
