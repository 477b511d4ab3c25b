#include "libcommon/options/pose_options.h"

namespace tdpt {

constexpr double kLongest = 1e6;  // seconds

void declare_pose_options(cli::Options& options, Pose& pose, cli::Effect effect) {
  options.part(cli::Part::animation);
  options.option("--at", pose.seconds, "SECONDS",
                 "Take the scene at this time of its animations; default their beginning",
                 -kLongest, kLongest, effect);
  options.option("--animation", pose.animations, "NAME",
                 "Apply this animation alone; may be repeated; default all, the first of two that "
                 "move the same thing",
                 effect);
}

}  // namespace tdpt
