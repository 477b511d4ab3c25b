// The command-line options of what blurs a picture: the lens and the shutter of its camera.
#pragma once
#include <optional>
#include <string>

#include "libcommon/cli/cli.h"
#include "libcommon/options/shot_options.h"
#include "libcommon/scene/film_plane.h"

namespace tdpt {

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

/// "f/2.8 at 2.5 m", "pinhole".
std::string lens_words(const LensArguments& a);
/// "2.31 m", "infinity".
std::string focus_words(double metres);
/// "180 degrees at 24 frames per second", "an instant".
std::string shutter_words(const LensArguments& a, const ShotArguments& shot);

}  // namespace tdpt
