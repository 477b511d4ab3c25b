// The command-line options that select a moment of the scene's animations, the same in every
// program that reads a scene.
#pragma once
#include "libcommon/cli/cli.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// --at, --animation.
void declare_pose_options(cli::Options& options, Pose& pose,
                          cli::Effect effect = cli::Effect::picture);

}  // namespace tdpt
