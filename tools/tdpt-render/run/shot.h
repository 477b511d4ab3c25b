// The frames of a shot: each is rendered as a picture of its own, with its time, its seed and its
// files. Frame K alone has the bytes of frame K of the shot, given the same plan.
#pragma once
#include <map>

#include "libcommon/options/shot_options.h"
#include "tools/tdpt-render/run/picture_run.h"

namespace tdpt {

/// Throws UsageError for options that do not go with --frames.
void check_frames(const Arguments& a, const cli::Common& common);

/// What the command line would say of one frame alone. Its seed is that of the shot plus the number
/// of the first frame whose samples it has: `since`.
struct FrameRun {
  Arguments arguments;
  cli::Common common;
};
FrameRun frame_run(const Arguments& a, const cli::Common& common, int64_t frame, int64_t since);

/// Renders the frames that are not there yet, complete and by the same command. Returns the exit
/// code.
int render_shot(const Arguments& a, const cli::Common& common, Workshop& shop);

}  // namespace tdpt
