// What a rendering leaves: checkpoints and previews while it lasts, its picture and what was asked
// for beside it at the end.
#pragma once
#include <optional>

#include "tools/tdpt-render/run/job.h"

namespace tdpt {

/// A rendering while it lasts, or where it has ended: `target` and `channels` belong to the end.
struct Outcome {
  const Job& job;
  const Choice& choice;
  RenderState& render_state;
  const Plan& plan;
  std::optional<TargetOutcome> target{};
  Channels channels{};
};

/// Writes the checkpoint. One that cannot be written costs nothing but a warning, as the one before
/// is whole; then false.
bool save(const Outcome& r);

/// Those of --aov that no sample changes: of several shards the first has them.
Channels channels_of(const Job& job, const World& world);

/// Writes the preview as it is, for whoever looks on. Whether it can be written the end tells.
void show(const Job& job, const Picture& picture);

/// Writes all that there is at the end. Throws Error for what cannot be written, and says where the
/// picture is kept.
void deliver(const Outcome& r, const RenderResult& result);

}  // namespace tdpt
