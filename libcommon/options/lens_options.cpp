#include "libcommon/options/lens_options.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/words.h"

namespace tdpt {

constexpr double kLongerSide = 0.036;  // of the film [m]

void declare_lens_options(cli::Options& options, LensArguments& a) {
  options.part(cli::Part::camera);
  options.option("--f-stop", a.f_stop, "N",
                 "Depth of field: f-number of the lens, as 2.8, on a film 36 mm along its longer "
                 "side; default a pinhole",
                 0.01, 1e6);
  options.option(
      "--focus", a.focus, "METRES",
      "Distance in front of the camera that --f-stop shows sharply; default that of what "
      "the middle of the picture shows",
      1e-6, 1e9);
  options.option("--shutter", a.shutter, "DEG",
                 "Motion blur of a moving camera: 360 is open from frame to frame, 180 for half of "
                 "the time, about the frame's; default an instant",
                 0, 360);
}

void check_lens(const LensArguments& a, const ShotArguments& shot, const Pose& pose,
                const std::string& device) {
  if (a.focus && !a.f_stop) throw UsageError("--focus: goes with --f-stop; a pinhole needs none");
  if (a.shutter > 0 && !shot.is_given() && !pose.seconds)
    throw UsageError("--shutter: needs --frames or --at, the time at which it is open");
  if (device.starts_with("gpu") && (a.f_stop || a.shutter > 0))
    throw UsageError(fmt::format("{}: --device gpu cannot blur; render with --device cpu",
                                 a.f_stop ? "--f-stop" : "--shutter"));
}

double aperture_radius(const FilmPlane& film, double f_stop) {
  const double focal_length = 0.5 * kLongerSide / std::max(film.half_width(), film.half_height());
  return 0.5 * focal_length / f_stop;
}

std::string lens_words(const LensArguments& a) {
  if (!a.f_stop) return "pinhole";
  return fmt::format("f/{} at {}", *a.f_stop,
                     a.focus ? fmt::format("{} m", *a.focus) : "what the middle shows");
}

std::string focus_words(double metres) {
  return std::isinf(metres) ? "infinity" : number_words(metres, 3) + " m";
}

std::string shutter_words(const LensArguments& a, const ShotArguments& shot) {
  if (a.shutter == 0) return "an instant";
  return fmt::format("{} degrees at {} frames per second", a.shutter, shot.fps);
}

}  // namespace tdpt
