// Renders a picture as planned, in passes over all pixels, and judges it by its target error.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "libcommon/options/picture_options.h"
#include "tools/tdpt-render/plan/plan.h"
#include "tools/tdpt-render/run/progress.h"

namespace tdpt {

/// What became of a target error.
struct TargetOutcome {
  double error = 0;    ///< the target
  uint64_t fixed = 0;  ///< samples per pixel that it takes; 0: not known
  /// "target": the fixed number was rendered; else "spp", "time", "signal", or "no light": the
  /// pilot met none and fixed no number.
  std::string stopped_by = "target";
  bool dark = false;           ///< nothing in the scene emits light: there is no error
  std::optional<Noise> noise;  ///< of the picture, estimated; none if no light was met
  bool reached() const { return dark || (noise && noise->relmse <= error); }
};

/// "target relMSE 0.01 reached: ..." or what stopped it. `spp`: samples per pixel of the picture.
std::string target_sentence(const TargetOutcome& target, uint64_t spp);
/// The object `target` of tdpt-json(5).
nlohmann::ordered_json target_json(const TargetOutcome& target, const ErrorPilot& pilot);
/// String attributes of the EXR header.
std::map<std::string, std::string> target_attributes(const TargetOutcome& target);

/// The picture after its first `spp` samples per pixel.
struct FrameRecord {
  uint64_t spp = 0;
  double nonzero = 0;                   ///< share of pixels that are not black
  Vec3d mean;                           ///< over all pixels
  double seconds = 0, cpu_seconds = 0;  ///< of rendering so far
};

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

/// The sums that the picture's film keeps.
Film::Options film_options(const Job& job, const std::vector<Candidate>& candidates);
/// A new picture, of which nothing is rendered yet.
Progress new_progress(const Session& session, const std::vector<Candidate>& candidates,
                      const Plan& plan);

/// Renders on until the goal is reached, or a limit or a signal ends it: passes over the whole
/// picture, so that all pixels have equally many samples whenever it stops. The picture is a
/// function of (scene, job, plan, samples) alone. `between`: called between passes, not counted as
/// rendering. If the renderer fails with an Error, `progress` holds all whole passes.
RenderResult render(Session& session, const Plan& plan, std::shared_ptr<Progress> progress,
                    const std::function<void()>& between = {});

/// The next number of samples above `spp` that is recorded: each up to 256, then each a sixteenth
/// more than the one before.
uint64_t next_frame(uint64_t spp);

}  // namespace tdpt
