// The frames of a shot: each is rendered as a picture of its own, with its time, its seed and its
// files. Frame K alone has the bytes of frame K of the shot.
#pragma once
#include "tools/tdpt-render/run/picture.h"

namespace tdpt {

/// Throws UsageError for options that do not go with --frames.
void check_frames(const RenderArguments& a, const cli::Common& common);

/// Renders the frames that are not there yet, complete and by the same command. Returns the exit
/// code.
int render_shot(const RenderArguments& a, const cli::Common& common, Scenery& scenery);

}  // namespace tdpt
