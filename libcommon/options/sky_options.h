// The options for light from infinity and for the units of the scene's lamps, the same in every
// program that needs the light.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libcommon/cli/cli.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

struct SkyArguments {
  std::string environment;           ///< path, "R,G,B" [W/m2/sr] or "none"; empty: not given
  std::optional<double> rotation{};  ///< [deg], counter-clockwise seen from above
  std::optional<double> scale{};     ///< factor on the environment's radiance
  double sun_angle = 0;              ///< full angular size of directional lamps [deg]; 0: none
  std::string light_units = "auto";  ///< or a name of LampUnits::Kind
};

/// --environment, --environment-rotation, --environment-scale, --sun-angle, --set light-units.
void declare_sky_options(cli::Options& options, SkyArguments& a);

/// The environment in use.
struct TakenSky {
  std::string environment;  ///< path, or "R,G,B" [W/m2/sr]; empty: none
  double rotation = 0, scale = 1;
  bool of_scene = false;  ///< it comes from the scene, not from the command line
};

/// The command line's environment, else the scene's; rotation and scale from the command line, else
/// from the scene.
TakenSky sky_of(const Scene& scene, const SkyArguments& a);

/// Converts the scene's lamps to W/sr and W/m2 and sets its sky: the environment, and the
/// directional lamps as suns of the given angle, which then are lamps no more. Without either there
/// is no sky. If the environment is a file, it is appended to `files`. Throws UsageError for a
/// malformed colour and for options that lack the one they depend on, InputError for a bad file.
TakenSky add_sky(Scene& scene, const SkyArguments& a, const cli::Common& common,
                 std::vector<cli::Common::Input>& files);

/// Warns if points and spots are a hundred times brighter than the emitting surfaces, which happens
/// when the two are in different units.
void warn_of_lamps(const Scene& scene, const cli::Common& common);

/// Names the unit of a scene that seems to be in another than metres [units.h]: a warning
/// where it has lamps, whose light depends on it, else a note.
void tell_unit(const Scene& scene, const cli::Common& common);

/// For a scene without light written by Blender's exporter, prints a note of what that leaves out.
void note_lost_light(const Scene& scene, const cli::Common& common);

}  // namespace tdpt
