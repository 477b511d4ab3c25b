// The options that say what shines from infinity and in what units the scene's lamps are, the same
// in every program that needs the light.
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
  std::optional<double> scale{};     ///< of the environment's radiance
  double sun_angle = 0;  ///< full angle that directional lamps are seen under [deg]; 0: none
  std::string light_units = "auto";  ///< or a name of LampUnits::Kind
};

/// --environment, --environment-rotation, --environment-scale, --sun-angle, --set light-units.
void declare_sky_options(cli::Options& options, SkyArguments& a);

/// The environment that is taken.
struct TakenSky {
  std::string environment;  ///< path, or "R,G,B" [W/m2/sr]; empty: none
  double rotation = 0, scale = 1;
  bool of_scene = false;  ///< the command line says nothing of it
};

/// That of the command line, else the scene's, which is turned and scaled as the command line says,
/// else as the scene does.
TakenSky sky_of(const Scene& scene, const SkyArguments& a);

/// Brings the scene's lamps to W/sr and W/m2 and gives it its sky: the environment, and its
/// directional lamps, which are lamps no more then, as suns of that angle. Without either there is
/// no sky. An environment that is a file is appended to `files`. Throws UsageError for a colour
/// that is none and for options without the one they belong to, InputError for a bad file.
TakenSky add_sky(Scene& scene, const SkyArguments& a, const cli::Common& common,
                 std::vector<cli::Common::Input>& files);

/// Warns where points and spots outshine the emitting surfaces a hundredfold, as they do when the
/// two are in different units.
void warn_of_lamps(const Scene& scene, const cli::Common& common);

/// A note for a scene without light that Blender's exporter wrote: what that leaves out.
void note_lost_light(const Scene& scene, const cli::Common& common);

}  // namespace tdpt
