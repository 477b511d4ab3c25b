// What the page of a shot shows, gathered for report_shot.py.
#pragma once
#include <string>

#include "tools/tdpt/request.h"

namespace tdpt {

/// The renderer's statistics of the frames of a shot: --stats, or beside the frames.
std::string stats_of_shot(const Arguments& a, const std::string& frames);

/// Writes into `folder`, which there is: strip.png, small pictures of frames side by side, as many
/// as a page bears, and shot.json, which names them and the statistics. All frames must be there.
/// Throws InputError, OutputError.
void gather_shot(const Arguments& a, const std::string& frames, const std::string& folder);

}  // namespace tdpt
