// Renders a picture as planned, in passes over all pixels.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/tdpt-render/plan/plan.h"
#include "tools/tdpt-render/run/progress.h"
#include "tools/tdpt-render/run/target.h"

namespace tdpt {

Vec3d mean_of(const Picture& picture);      ///< over all pixels
double nonzero_of(const Picture& picture);  ///< share of pixels that are not black

/// A picture as it was rendered, and what its film tells.
struct RenderResult {
  Plan plan;
  std::shared_ptr<Progress> progress;
  Picture picture;  ///< with its alpha if the job asks for it
  RenderTally tally;
  std::vector<FrameRecord> frames;      ///< if the job asks for them; the last one is the picture
  std::optional<Noise> noise;           ///< of the picture, if it is known
  std::optional<TargetOutcome> target;  ///< if there is one

  uint64_t spp() const { return progress->film.samples(); }
  Vec3d mean() const { return mean_of(picture); }
  double nonzero() const { return nonzero_of(picture); }
};

/// Called between passes over the picture about every so many seconds, for at most a tenth of the
/// time; not counted as rendering.
struct Visitor {
  double every;  ///< seconds
  std::function<void(const Plan&, Progress&)> visit;
};

/// The sums that the picture's film keeps.
Film::Options film_options(const Job& job, const std::vector<Candidate>& candidates);
/// A new picture, of which nothing is rendered yet.
Progress new_progress(const Session& session, const std::vector<Candidate>& candidates,
                      const Plan& plan);

/// Renders on until the goal is reached, or a limit or a signal ends it: passes over the whole
/// picture, so that all pixels have equally many samples whenever it stops. The picture is a
/// function of (scene, job, plan, samples) alone. `rescue`: called if the renderer fails with an
/// Error, to save what has been rendered.
RenderResult render(Session& session, const Plan& plan, std::shared_ptr<Progress> progress,
                    const std::vector<Visitor>& visitors = {},
                    const std::function<void(const Plan&, Progress&)>& rescue = {});

/// Plans and renders, without exploring: portals work as drawn.
RenderResult render(SampleRenderer& renderer, const std::vector<Candidate>& candidates,
                    const Job& job);
RenderResult render(SampleRenderer& renderer, const Integrator& integrator, const Job& job);
/// On the CPU.
RenderResult render(const Vista& vista, const std::vector<Candidate>& candidates, const Job& job);
RenderResult render(const Vista& vista, const Integrator& integrator, const Job& job);

/// The next number of samples above `spp` that is recorded: each up to 256, then each a sixteenth
/// more than the one before.
uint64_t next_frame(uint64_t spp);

}  // namespace tdpt
