// The files of a rendering: checkpoints and previews on the way, the picture and whatever else was
// asked for at the end.
#pragma once
#include <optional>

#include "tools/tdpt-render/run/job.h"

namespace tdpt {

/// A rendering in progress or at its end; `target`, `channels` and `mark` are set at the end.
struct Outcome {
  const Job& job;
  const Choice& choice;
  RenderState& render_state;
  const Plan& plan;
  std::optional<TargetOutcome> target{};
  Channels channels{};
  std::string mark{};  ///< Job::mark of a frame that is complete
};

/// Name of the attribute with Job::mark.
inline constexpr const char* kFrameAttribute = "frame";

/// Writes the checkpoint. A failure is only a warning, since the previous one stays whole; returns
/// false then.
bool save(const Outcome& r);

/// The --aov channels that samples do not change: among shards only the first has them.
Channels channels_of(const Job& job, const World& world);

/// Writes the preview. A failure is ignored: the final write will report it.
void show(const Job& job, const Picture& picture);

struct Delivered {
  std::string filtered{};  ///< what the filter did, in a sentence; empty without --denoise
  std::optional<double> exposure{};  ///< of the preview [stops]; nothing without one
};
/// Writes everything at the end. Throws Error for what cannot be written, and says where the
/// picture is kept.
Delivered deliver(const Outcome& r, const RenderResult& result);

}  // namespace tdpt
