// The command-line options that select a scene's camera, its lens and its shutter, the same in
// every program that needs one.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libcommon/cli/cli.h"
#include "libcommon/options/shot_options.h"
#include "libcommon/scene/film_plane.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

struct CameraArguments {
  std::vector<std::string> names;      ///< of cameras in the scene; none: the default one
  std::string look_from, look_at, up;  ///< "X,Y,Z" [m, `up` of any length]; empty: not given
  double fov = 0;                      ///< full vertical angle [deg]; 0: not given
  bool frame = false;                  ///< place a camera that sees the whole scene
  bool cull = false;                   ///< Camera::culls
};

/// --camera, --look-from, --look-at, --up, --fov, --frame, --cull.
void declare_camera_options(cli::Options& options, CameraArguments& a);

/// The camera that the options select; for --frame, prints a note of its position. Throws
/// UsageError for contradictory options, several cameras and malformed positions, InputError if the
/// scene has no such camera.
Camera chosen_camera(const Scene& scene, const CameraArguments& a, const cli::Common& common);

/// The same for a program that takes several: each value of --camera is a name, or several names
/// with commas between them, or `all`. Each camera once, in the order of the options; those of
/// `all` in the order of the scene, without malformed ones.
std::vector<Camera> chosen_cameras(const Scene& scene, const CameraArguments& a,
                                   const cli::Common& common);

/// The names of the cameras that values of --camera select: exact names first, so that a camera may
/// be called "all" or "a,b". Names that no camera has are kept.
std::vector<std::string> names_of_cameras(const Scene& scene,
                                          const std::vector<std::string>& given);

/// The camera of --frame: in front of the scene, to the right and above, as close as possible while
/// showing all of it in every picture at least as wide as high. `yfov`: full vertical angle [rad].
Camera framing_camera(const Scene& scene, double yfov);

struct LensArguments {
  std::optional<double> f_stop;  ///< focal length over diameter of the aperture; none: a pinhole
  std::optional<double> focus;   ///< [m] in front of the camera; none: what the middle shows
  double shutter = 0;  ///< [deg] of 360 for the whole time between two frames; 0: an instant
};

/// --f-stop, --focus, --shutter.
void declare_lens_options(cli::Options& options, LensArguments& a);

/// Throws UsageError for options that contradict each other.
void check_lens(const LensArguments& a, const ShotArguments& shot, const Pose& pose,
                const std::string& device);

/// Radius of the aperture [m] of a camera whose picture is 36 mm along its longer side, as of film
/// for 35 mm: focal length / (2 f_stop). `film`: its angles of view.
double aperture_radius(const FilmPlane& film, double f_stop);

/// "2.31 m", "infinity".
std::string focus_words(double metres);
/// "180 degrees at 24 frames per second", "an instant".
std::string shutter_words(const LensArguments& a, const ShotArguments& shot);

}  // namespace tdpt
