// The options that say through which camera a scene is looked at, the same in every program that
// needs one.
#pragma once
#include <string>

#include "libcommon/cli/cli.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

struct CameraArguments {
  std::string name;                    ///< of one in the scene; empty: the first
  std::string look_from, look_at, up;  ///< "X,Y,Z" [m, `up` of any length]; empty: not given
  double fov = 0;                      ///< full vertical angle [deg]; 0: not given
  bool frame = false;                  ///< one that has all of the scene in view
  bool cull = false;                   ///< Camera::culls
};

/// --camera, --look-from, --look-at, --up, --fov, --frame, --cull.
void declare_camera_options(cli::Options& options, CameraArguments& a);

/// The camera that they say; of --frame a note says where it stands. Throws UsageError for options
/// that contradict each other and for what is no place, InputError where the scene has no such
/// camera.
Camera chosen_camera(const Scene& scene, const CameraArguments& a, const cli::Common& common);

/// That of --frame: a place before the scene, to the right and above, as close as shows all of it
/// in every picture that is at least as wide as high. `yfov`: full vertical angle [rad].
Camera framing_camera(const Scene& scene, double yfov);

}  // namespace tdpt
