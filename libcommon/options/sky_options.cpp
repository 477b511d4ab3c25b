#include "libcommon/options/sky_options.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/environment.h"
#include "libcommon/scene/gltf/defaults.h"
#include "libcommon/scene/units.h"

namespace tdpt {
namespace {

constexpr const char* kNone = "none";  // value for no environment
constexpr double kSmallestSun = 0.01;  // [deg]
constexpr double kRadians = std::numbers::pi / 180;

bool is_file(const std::string& value) {
  if (value.empty())
    throw UsageError("--environment: nothing given, expected a file, R,G,B or none");
  return value != kNone && !means_colour(value);
}

// The colour of the command line, or of the scene, where it has been validated.
Rgb colour_of(const std::string& text) {
  std::string expected;
  const auto colour = parse_colour(text, expected);
  if (!colour) throw UsageError(fmt::format("--environment {}: expected {}", text, expected));
  return *colour;
}

void check(const SkyArguments& a, const TakenSky& sky) {
  if (sky.environment.empty() && (a.rotation || a.scale))
    throw UsageError(std::string(a.rotation ? "--environment-rotation" : "--environment-scale") +
                     " goes with --environment" +
                     (a.environment == kNone ? ", not with none" : ""));
  if (a.sun_angle != 0 && a.sun_angle < kSmallestSun)
    throw UsageError(
        fmt::format("--sun-angle {}: expected 0, or {} to 90", a.sun_angle, kSmallestSun));
}

// A disc with radiance L and half angle h gives a perpendicular plane the irradiance pi L sin^2 h.
std::vector<Sky::Sun> take_suns(Scene& scene, double half_angle) {
  const double s = std::sin(half_angle);
  std::vector<Sky::Sun> suns;
  std::erase_if(scene.lights, [&](const PunctualLight& lamp) {
    if (lamp.kind != PunctualLight::Kind::directional) return false;
    suns.push_back(
        {-lamp.direction, half_angle, Rgb(Vec3d(lamp.intensity) / (std::numbers::pi * s * s))});
    return true;
  });
  return suns;
}

// Hash of what decides where light comes from; its power is left out, since portals do not depend
// on it.
std::string hash_of(const Sky::Map& map, double rotation, double sun_angle) {
  const std::string texels = content_hash(
      {reinterpret_cast<const char*>(map.texels.data()), map.texels.size() * sizeof(Rgb)});
  const bool even = map.texels.empty() || map.width * map.height == 1;
  return content_hash(fmt::format("{} {} {} {} {}", map.width, map.height, texels,
                                  even ? 0.0 : std::remainder(rotation, 360), sun_angle));
}

// A file named by the scene is not on the command line, but an output must not overwrite it either.
Sky::Map read_map(const Scene& scene, const TakenSky& sky, const cli::Common& common,
                  std::vector<cli::Common::Input>& files) {
  if (sky.environment.empty()) return {};
  if (means_colour(sky.environment)) return {1, 1, {colour_of(sky.environment)}};
  if (sky.of_scene && scene.defaults.environment_fault)
    throw InputError(*scene.defaults.environment_fault);
  if (sky.of_scene) common.also_read({sky.environment});
  const std::string bytes = read_file(sky.environment);
  files.push_back({sky.environment, content_hash(bytes), {}});
  return parse_environment(bytes, display_name(sky.environment));
}

void scale(const Scene& scene, bool said_by_scene, double factor, Sky::Map& map) {
  for (Rgb& texel : map.texels) {
    texel = Rgb(Vec3d(texel) * factor);
    for (int c = 0; c < 3; ++c)
      if (texel[c] < kFaintestSky) texel[c] = 0;
    if (max_component(texel) <= static_cast<float>(kBrightestSky)) continue;
    const std::string beyond = fmt::format("brings the environment beyond {:.0e}", kBrightestSky);
    if (said_by_scene)
      throw InputError(display_name(scene.path), scene.defaults.place_of("tdpt_environment_scale"),
                       fmt::format("is {}, which {}", factor, beyond));
    throw UsageError(fmt::format("--environment-scale {}: {}", factor, beyond));
  }
}

LampUnits::Kind units_of(const Scene& scene, const std::string& name) {
  const std::vector<std::string>& names = names_of_lamp_units();
  const auto at = std::find(names.begin(), names.end(), name);
  return at == names.end() ? scene.lamp_units.kind
                           : static_cast<LampUnits::Kind>(at - names.begin());
}

// Converts the lamps to W/sr, W/m2 and W/m2/sr. Returns the contribution to the scene's identity:
// in other units than the inferred ones the balance among lamps and surfaces may be another.
std::string take_lamps(Scene& scene, const SkyArguments& a, const cli::Common& common) {
  if (!scene.has_lamps()) return "";
  if (a.light_units == "auto" && !scene.lamp_units.reason.empty())
    common.note(scene.lamp_units.reason);
  const LampUnits::Kind units = units_of(scene, a.light_units);
  const bool inferred = units == scene.lamp_units.kind;
  take_lamps_as(scene, units);
  scene.lamp_units.kind = units;
  return inferred ? "" : content_hash("lamps " + a.light_units);
}

}  // namespace

void declare_sky_options(cli::Options& options, SkyArguments& a) {
  options.part(cli::Part::light);
  options.input_or_setting(
      "--environment", a.environment, "FILE|R,G,B",
      "What shines from all around: latitude-longitude map (.exr, .hdr) or "
      "one colour, W/m2/sr; default what the scene names, which 'none' leaves out",
      is_file);
  options.option("--environment-rotation,--set environment-rotation", a.rotation, "DEG",
                 "Turn the environment about the vertical, counter-clockwise from above; default "
                 "as the scene says, else 0",
                 -360, 360);
  options.option("--environment-scale,--set environment-scale", a.scale, "S",
                 "Multiply the environment by S; default as the scene says, else 1", 1e-9, 1e9);
  options.option("--sun-angle", a.sun_angle, "DEG",
                 "Angle that directional lamps are seen under; default 0, parallel light", 0, 90);
  std::vector<std::string> units = names_of_lamp_units();
  units.insert(units.begin(), "auto");
  options.choice("--set light-units", a.light_units, units,
                 "Units of the scene's lamps; default auto, by who wrote the file");
}

TakenSky sky_of(const Scene& scene, const SkyArguments& a) {
  const SceneDefaults& d = scene.defaults;
  TakenSky sky{"", a.rotation.value_or(0), a.scale.value_or(1), a.environment.empty()};
  if (!sky.of_scene) {
    if (a.environment != kNone) sky.environment = a.environment;
    return sky;
  }
  if (!d.has_environment()) return sky;
  const bool is_colour = means_colour(d.environment);
  sky.environment = is_colour || d.environment_file.empty() ? d.environment : d.environment_file;
  if (!is_colour && means_colour(sky.environment)) sky.environment = "./" + sky.environment;
  sky.rotation = a.rotation.value_or(d.rotation.value_or(0));
  sky.scale = a.scale.value_or(d.scale.value_or(1));
  return sky;
}

void add_sky(Scene& scene, const SkyArguments& a, const cli::Common& common,
             std::vector<cli::Common::Input>& files) {
  const TakenSky sky = sky_of(scene, a);
  check(a, sky);
  scene.sky_hash = take_lamps(scene, a, common);
  Sky::Map map = read_map(scene, sky, common, files);
  std::vector<Sky::Sun> suns;
  if (a.sun_angle > 0) suns = take_suns(scene, 0.5 * a.sun_angle * kRadians);
  if (map.texels.empty() && suns.empty()) return;
  const std::string sky_hash = hash_of(map, sky.rotation, suns.empty() ? 0 : a.sun_angle);
  scene.sky_hash = scene.sky_hash.empty() ? sky_hash : content_hash(scene.sky_hash + sky_hash);
  scale(scene, sky.of_scene && !a.scale, sky.scale, map);
  scene.sky = std::make_shared<Sky>(std::move(map), sky.rotation * kRadians, std::move(suns));
}

void note_lost_light(const Scene& scene, const cli::Common& common) {
  const bool emits = std::any_of(scene.materials.begin(), scene.materials.end(),
                                 [](const Material& m) { return max_component(m.emission) > 0; });
  if (!scene.by_blender || scene.sky || scene.has_lamps() || emits) return;
  common.note(
      "Blender's exporter leaves out the world (sky) and area lamps, and other lamps "
      "unless Include > Punctual Lights is ticked: tdpt's Blender extension exports "
      "them, or --environment a sky; see LIGHTS in gltf-scene(5)");
}

void note_unit(const Scene& scene, const cli::Common& common) {
  const std::optional<SceneUnit> unit = unit_of(scene);
  if (!unit) return;
  const std::string sentence =
      fmt::format("{}: its rooms are {} m high, so it seems to be in {}, and glTF is in metres",
                  display_name(scene.path), number_words(unit->height, 2), unit->name);
  const std::string advice = fmt::format("export it scaled by {}", unit->metres);
  const bool has_lamps = std::any_of(
      scene.lights.begin(), scene.lights.end(),
      [](const PunctualLight& lamp) { return lamp.kind != PunctualLight::Kind::directional; });
  if (has_lamps)
    common.warn(fmt::format("{}: its lamps are {} times too weak; {}", sentence,
                            number_words(1 / (unit->metres * unit->metres), 2), advice));
  else
    common.note(sentence + ": " + advice);
}

}  // namespace tdpt
