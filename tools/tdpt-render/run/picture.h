// The making of pictures, from what the command line says to the files: of one, or of the frames of
// a shot. A frame is rendered as a picture of its own, with its time, its seed and its files: frame
// K alone has the bytes of frame K of the shot.
#pragma once
#include <optional>
#include <string>

#include "tools/tdpt-render/run/scene_cache.h"

namespace tdpt {

/// How a picture ended.
struct Outcome {
  int code = 0;         ///< exit code
  std::string words{};  ///< how many samples, how long, how noisy
};
/// Makes the picture. `frame`: its number, if it is of a shot.
Outcome render_picture(const RenderArguments& a, const cli::Common& common, SceneCache& scenes,
                       std::optional<int64_t> frame = {});

/// Value of kFrameAttribute for a complete frame of a shot: its number and a hash of all that
/// determines it. `portals`: hashes of its portal files.
std::string frame_mark(const Scene& scene, const std::vector<std::string>& portals,
                       const cli::Common& common, int64_t frame);

/// Throws UsageError for options that do not go with --frames.
void check_frames(const RenderArguments& a, const cli::Common& common);

/// Renders the frames that are not there yet, complete and by the same command. Returns the exit
/// code.
int render_shot(const RenderArguments& a, const cli::Common& common, SceneCache& scenes);

}  // namespace tdpt
