// The making of one picture: from what the command line says to the files.
#pragma once
#include <optional>
#include <string>

#include "tools/tdpt-render/run/scenery.h"

namespace tdpt {

/// Everything that determines a picture of the scene, or the `frame` of a shot. `portals`: hashes
/// of its portal files.
Fingerprint fingerprint_of(const Scene& scene, const std::vector<std::string>& portals,
                           const cli::Common& common, std::optional<int64_t> frame,
                           cli::Effect up_to);
/// Value of kFrameAttribute for a complete frame: its number and a hash of all that determines it.
std::string frame_mark(const Scene& scene, const std::vector<std::string>& portals,
                       const cli::Common& common, int64_t frame);

/// How a picture ended.
struct Made {
  int code = 0;         ///< exit code
  std::string words{};  ///< how many samples, how long, how noisy
};
/// Makes the picture. `frame`: its number, if it is of a shot.
Made render_picture(const RenderArguments& a, const cli::Common& common, Scenery& scenery,
                    std::optional<int64_t> frame = {});

}  // namespace tdpt
