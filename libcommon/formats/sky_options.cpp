#include "libcommon/formats/sky_options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/hash.h"
#include "libcommon/base/number_words.h"
#include "libcommon/formats/environment.h"
#include "libcommon/scene/lights.h"

namespace tdpt {
namespace {

constexpr double kBrightest = 1e30, kFaintest = 1e-30;  // [W/m2/sr]
constexpr double kSmallestSun = 0.01;                   // [deg]
constexpr double kRadians = std::numbers::pi / 180;
constexpr double kOutshines = 100;  // in power, beyond which lamps and surfaces hardly go together

std::optional<float> number(std::string_view text) {
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

// Three numbers are meant, however badly put: what has commas and is no path, or is a number.
bool means_colour(const std::string& value) {
  if (value.find('/') != std::string::npos) return false;
  for (const char* suffix : {".exr", ".hdr", ".pic"})
    if (value.ends_with(suffix)) return false;
  return value.find(',') != std::string::npos || number(value);
}

bool is_file(const std::string& value) {
  if (value.empty()) throw UsageError("--environment: nothing given, expected a file or R,G,B");
  return !means_colour(value);
}

Rgb colour_of(const std::string& text) {
  const auto fail = [&](const std::string& expected) {
    throw UsageError(fmt::format("--environment {}: expected {}", text, expected));
  };
  Rgb colour{};
  size_t start = 0;
  for (int c = 0; c < 3; ++c) {
    const size_t end = c < 2 ? text.find(',', start) : text.size();
    const auto value = end == std::string::npos
                           ? std::nullopt
                           : number(std::string_view(text).substr(start, end - start));
    if (!value || !(*value >= 0 && *value <= kBrightest))
      fail("a file, or R,G,B: three numbers from 0 to 1e30");
    colour[c] = *value;
    start = end + 1;
  }
  if (max_component(colour) < kFaintest) fail("a colour that is not black");
  return colour;
}

void check(const SkyArguments& a) {
  if (a.environment.empty() && (a.rotation != 0 || a.scale != 1))
    throw UsageError(
        std::string(a.rotation != 0 ? "--environment-rotation" : "--environment-scale") +
        " goes with --environment");
  if (a.sun_angle != 0 && a.sun_angle < kSmallestSun)
    throw UsageError(
        fmt::format("--sun-angle {}: expected 0, or {} to 90", a.sun_angle, kSmallestSun));
}

// A disc of radiance L and half angle h brings a plane across it the irradiance pi L sin^2 h.
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

// Of what decides where light comes from: portals do not move with its power.
std::string hash_of(const Sky::Map& map, double rotation, double sun_angle) {
  const std::string texels = content_hash(
      {reinterpret_cast<const char*>(map.texels.data()), map.texels.size() * sizeof(Rgb)});
  const bool even = map.texels.empty() || map.width * map.height == 1;
  return content_hash(fmt::format("{} {} {} {} {}", map.width, map.height, texels,
                                  even ? 0.0 : std::remainder(rotation, 360), sun_angle));
}

Sky::Map read_map(const SkyArguments& a, std::vector<cli::Common::Input>& files) {
  if (a.environment.empty()) return {};
  if (means_colour(a.environment)) return {1, 1, {colour_of(a.environment)}};
  const std::string bytes = read_file(a.environment);
  files.push_back({a.environment, content_hash(bytes), {}});
  return parse_environment(bytes, display_name(a.environment));
}

void scale(Sky::Map& map, double factor) {
  for (Rgb& texel : map.texels) {
    texel = Rgb(Vec3d(texel) * factor);
    for (int c = 0; c < 3; ++c)
      if (texel[c] < kFaintest) texel[c] = 0;
    if (!(max_component(texel) <= static_cast<float>(kBrightest)))
      throw UsageError(fmt::format("--environment-scale {}: brings the environment beyond {:.0e}",
                                   factor, kBrightest));
  }
}

bool has_emission(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return max_component(m.emission) > 0; });
}

LampUnits::Kind units_of(const Scene& scene, const std::string& name) {
  const std::vector<std::string>& names = names_of_lamp_units();
  const auto at = std::find(names.begin(), names.end(), name);
  return at == names.end() ? scene.lamp_units.kind
                           : static_cast<LampUnits::Kind>(at - names.begin());
}

// Whether lamps in these units stand to each other, or to what else shines, as they do not in those
// that are most likely: then light comes from elsewhere.
bool shifts_light(const Scene& scene, LampUnits::Kind units, bool with_map) {
  std::vector<double> changes;
  for (const PunctualLight& lamp : scene.lights) {
    const bool sun = lamp.kind == PunctualLight::Kind::directional;
    changes.push_back(to_radiometric(units, sun) / to_radiometric(scene.lamp_units.kind, sun));
  }
  if (with_map || has_emission(scene)) changes.push_back(1);
  return std::adjacent_find(changes.begin(), changes.end(), std::not_equal_to<>()) != changes.end();
}

// Brings the lamps to W/sr and W/m2. Returns what the identity of the scene has of it.
std::string take_lamps(Scene& scene, const SkyArguments& a, const cli::Common& common) {
  if (scene.lights.empty()) {
    if (a.light_units != "auto")
      common.note_of(scene.path, "the scene has no lamp: --light-units changes nothing");
    return "";
  }
  if (a.light_units == "auto" && !scene.lamp_units.reason.empty())
    common.note_of(scene.path, scene.lamp_units.reason);
  const LampUnits::Kind units = units_of(scene, a.light_units);
  const bool shifted = shifts_light(scene, units, !a.environment.empty());
  take_lamps_as(scene, units);
  scene.lamp_units.kind = units;
  return shifted ? content_hash("lamps " + a.light_units) : "";
}

}  // namespace

void declare_sky_options(cli::Options& options, SkyArguments& a) {
  options.input_or_setting("--environment", a.environment, "FILE|R,G,B",
                           "What shines from all around: latitude-longitude map (.exr, .hdr) or "
                           "one colour, W/m2/sr",
                           is_file);
  options.option("--environment-rotation", a.rotation, "DEG",
                 "Turn the environment about the vertical, counter-clockwise from above; default 0",
                 -360, 360);
  options.option("--environment-scale", a.scale, "S", "Multiply the environment by S; default 1",
                 1e-9, 1e9);
  options.option("--sun-angle", a.sun_angle, "DEG",
                 "Angle that directional lamps are seen under; default 0, parallel light", 0, 90);
  std::vector<std::string> units = names_of_lamp_units();
  units.insert(units.begin(), "auto");
  options.choice("--light-units", a.light_units, units,
                 "Units of the scene's lamps; default auto, by who wrote the file");
}

void add_sky(Scene& scene, const SkyArguments& a, const cli::Common& common,
             std::vector<cli::Common::Input>& files) {
  check(a);
  scene.sky_hash = take_lamps(scene, a, common);
  Sky::Map map = read_map(a, files);
  std::vector<Sky::Sun> suns;
  if (a.sun_angle > 0) suns = take_suns(scene, 0.5 * a.sun_angle * kRadians);
  if (a.sun_angle > 0 && suns.empty())
    common.note_of(scene.path, "the scene has no directional lamp: --sun-angle changes nothing");
  if (map.texels.empty() && suns.empty()) return;
  if (scene.lights.empty()) std::erase(scene.needs, "punctual lights");
  scene.needs.push_back("a sky");
  const std::string sky_hash = hash_of(map, a.rotation, suns.empty() ? 0 : a.sun_angle);
  scene.sky_hash = scene.sky_hash.empty() ? sky_hash : content_hash(scene.sky_hash + sky_hash);
  scale(map, a.scale);
  scene.sky = std::make_shared<Sky>(std::move(map), a.rotation * kRadians, std::move(suns));
}

void warn_of_lamps(const Scene& scene, const cli::Common& common) {
  if (scene.lights.empty() || !has_emission(scene)) return;
  const Lights::Shares power = Lights(scene).powers();
  if (!(power.surfaces > 0 && power.lamps > kOutshines * power.surfaces)) return;
  const bool as_they_are = scene.lamp_units.kind == LampUnits::Kind::radiometric;
  common.warn_of(
      scene.path,
      fmt::format("lamps have {} times the power of the surfaces that emit: if that is not "
                  "meant, {}",
                  number_words(power.lamps / power.surfaces),
                  as_they_are
                      ? "their units differ, and --light-units photometric divides lamps by 683"
                      : "--light-units says in what their numbers are"));
}

}  // namespace tdpt
