// The files of a rendering: checkpoints and previews on the way, the picture and whatever else was
// asked for at the end.
#pragma once
#include <optional>
#include <span>

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
  std::string mark{};  ///< Job::mark, or kIncomplete
};

/// Value of kFrameAttribute for a frame that a signal interrupted.
inline constexpr const char* kIncomplete = "incomplete";

/// Writes the checkpoint. A failure is only a warning, since the previous one stays whole; returns
/// false then.
bool save(const Outcome& r);

/// The --aov channels that samples do not change: among shards only the first has them.
Channels channels_of(const Job& job, const World& world);

/// Writes the preview. A failure is ignored: the final write will report it.
void show(const Job& job, const Picture& picture);

struct Delivered {
  std::string filtered{};  ///< what the filter did, in a sentence; empty without --denoise
  std::optional<double> exposure{};          ///< of the preview [stops]; nothing without one
  std::optional<denoise::ErrorLeft> left{};  ///< of a filtered picture, if it is known
};
/// The JSON of stats_json() or summary_json() with that.
std::string finished_json(const std::string& told, const Delivered& delivered);
/// Writes everything at the end. Throws Error for what cannot be written, and says where the
/// picture is kept.
Delivered deliver(const Outcome& r, const RenderResult& result);

/// Of a shot whose frames are filtered together, in two steps: first a frame's picture is handed
/// over with the sums of its halves, its features and its statistics; then, when the frames beside
/// it are there, too, it is filtered and written.
struct Unfiltered {
  ExrFile file;
  FilmFacts facts;
  bool both_halves = false;  ///< it can be filtered
  std::string stats{};       ///< stats_json()
};
Unfiltered hand_over(const Outcome& r, const RenderResult& result);
/// `frames`: those beside it, by names for people.
Delivered deliver_frame(const Arguments& a, const cli::Common& common, Unfiltered picture,
                        std::span<const denoise::NamedPicture> frames);

/// Name of the attribute that lists the frames with which a frame was filtered.
inline constexpr const char* kFramesAttribute = "denoiserFrames";

}  // namespace tdpt
