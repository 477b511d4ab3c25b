// The command-line options that select a moment of the scene's animations, the same in every
// program that reads a scene.
#pragma once
#include "libcommon/cli/cli.h"
#include "libcommon/scene/pose.h"

namespace tdpt {

/// --at, --animation. `shapes`: whether the result depends on them.
void declare_pose_options(cli::Options& options, Pose& pose,
                          cli::Shapes shapes = cli::Shapes::result);

}  // namespace tdpt
