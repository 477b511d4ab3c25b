#include "libcommon/scene/units.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

namespace {

using Kind = LampUnits::Kind;
constexpr double kSphere = 4 * std::numbers::pi;  // [sr]
constexpr std::string_view kBlender = "Khronos glTF Blender I/O v";

// The value that the user had set if the number was written in these units: W, or W/m2 for a sun.
double setting(const LampNumber& lamp, Kind units) {
  const double radiometric = lamp.value * to_radiometric(units, lamp.directional);
  return lamp.directional ? radiometric : radiometric * kSphere;
}

// Whether a person may have typed it: a decimal of at most four digits, in single precision. One of
// a thousand other numbers passes by chance.
bool is_typed(double value) {
  if (!(value >= 1e-6 && value <= 1e12)) return false;
  const double typed = std::stod(fmt::format("{:.4g}", value));
  return std::abs(value - typed) <= 0x1.01p-24 * typed;
}

// The units for which most lamps have such values; photometric if there is a tie.
std::optional<Kind> by_digits(const std::vector<LampNumber>& lamps) {
  std::optional<Kind> best;
  size_t most = lamps.size() / 2;
  for (const Kind units : {Kind::photometric, Kind::radiometric, Kind::watts}) {
    const auto n =
        static_cast<size_t>(std::count_if(lamps.begin(), lamps.end(), [&](const LampNumber& l) {
          return is_typed(setting(l, units));
        }));
    if (n <= most) continue;
    most = n;
    best = units;
  }
  return best;
}

const char* words_of(Kind units) {
  switch (units) {
    case Kind::photometric:
      return "candela and lux, divided by 683 lm/W";
    case Kind::watts:
      return "points and spots of so many watts, divided by 4 pi";
    case Kind::radiometric:
      break;
  }
  return "W/sr and W/m2";
}

}  // namespace

const std::vector<std::string>& names_of_lamp_units() {
  static const std::vector<std::string> names{"radiometric", "photometric", "watts"};
  return names;
}

bool is_blender(std::string_view generator) {
  return generator.starts_with(kBlender);
}

LampUnits lamp_units_of(std::string_view generator, const std::vector<LampNumber>& lamps) {
  if (lamps.empty()) return {};
  const auto digits = by_digits(lamps);
  if (!is_blender(generator))
    return {Kind::radiometric,
            digits == Kind::photometric
                ? "lamps are taken as W/sr and W/m2, but have the digits of Blender's candela: "
                  "--set light-units=photometric would divide them by 683 lm/W"
                : ""};
  const Kind kind = digits.value_or(Kind::photometric);
  return {kind,
          fmt::format("lamps are taken as {}: so Blender's exporter writes them {}", words_of(kind),
                      !digits                     ? "unless told otherwise"
                      : kind == Kind::photometric ? "by default"
                      : kind == Kind::watts       ? "in its raw mode, by their digits"
                                                  : "in its unitless mode, by their digits")};
}

double to_radiometric(LampUnits::Kind units, bool directional) {
  switch (units) {
    case Kind::photometric:
      return 1 / LampUnits::kLumensPerWatt;
    case Kind::watts:
      return directional ? 1 : 1 / kSphere;
    case Kind::radiometric:
      break;
  }
  return 1;
}

double to_radiometric(Kind units, const PunctualLight& lamp) {
  if (lamp.profile && units == Kind::watts) units = Kind::photometric;
  return to_radiometric(units, lamp.kind == PunctualLight::Kind::directional);
}

double to_radiometric(Kind units, const AreaLight& light) {
  // A black surface of radiance L emits the power pi L A from its front.
  return units == Kind::watts ? 1 / (std::numbers::pi * light.area) : to_radiometric(units, true);
}

void take_lamps_as(Scene& scene, LampUnits::Kind units) {
  if (units == Kind::radiometric) return;
  for (const AreaLight& light : scene.area_lights) {
    Material& m = scene.materials[light.material];
    const Vec3d radiance = Vec3d(m.emission) * to_radiometric(units, light);
    const double most = max_component(radiance);
    if (!(most <= kBrightestEmission))
      throw InputError(
          display_name(scene.path), "",
          fmt::format("area light \"{}\" of {} m2 emits a radiance of {}, expected at "
                      "most 1e30",
                      shown(m.name, 40), number_words(light.area), number_words(most)));
    m.emission = Rgb(most < kFaintestEmission ? Vec3d() : radiance);
  }
  for (PunctualLight& lamp : scene.lights)
    lamp.intensity = Rgb(Vec3d(lamp.intensity) * to_radiometric(units, lamp));
}

}  // namespace tdpt
