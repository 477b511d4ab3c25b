#include "libcommon/scene/units.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

namespace {

using LampUnit = LampUnits::Kind;
constexpr double kSphere = 4 * std::numbers::pi;  // [sr]
constexpr std::string_view kBlender = "Khronos glTF Blender I/O v";

// The value that the user had set if the number was written in these units: W, or W/m2 for a sun.
double setting(const LampNumber& lamp, LampUnit units) {
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
std::optional<LampUnit> by_digits(const std::vector<LampNumber>& lamps) {
  std::optional<LampUnit> best;
  size_t most = lamps.size() / 2;
  for (const LampUnit units : {LampUnit::photometric, LampUnit::radiometric, LampUnit::watts}) {
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

const char* words_of(LampUnit units) {
  switch (units) {
    case LampUnit::photometric:
      return "candela and lux, divided by 683 lm/W";
    case LampUnit::watts:
      return "points and spots of so many watts, divided by 4 pi";
    case LampUnit::radiometric:
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
    return {LampUnit::radiometric,
            digits == LampUnit::photometric
                ? "lamps are taken as W/sr and W/m2, but have the digits of Blender's candela: "
                  "--set light-units=photometric would divide them by 683 lm/W"
                : ""};
  const LampUnit kind = digits.value_or(LampUnit::photometric);
  return {kind,
          fmt::format("lamps are taken as {}: so Blender's exporter writes them {}", words_of(kind),
                      !digits                         ? "unless told otherwise"
                      : kind == LampUnit::photometric ? "by default"
                      : kind == LampUnit::watts       ? "in its raw mode, by their digits"
                                                      : "in its unitless mode, by their digits")};
}

double to_radiometric(LampUnits::Kind units, bool directional) {
  switch (units) {
    case LampUnit::photometric:
      return 1 / LampUnits::kLumensPerWatt;
    case LampUnit::watts:
      return directional ? 1 : 1 / kSphere;
    case LampUnit::radiometric:
      break;
  }
  return 1;
}

double to_radiometric(LampUnit units, const PunctualLight& lamp) {
  if (lamp.profile && units == LampUnit::watts) units = LampUnit::photometric;
  return to_radiometric(units, lamp.kind == PunctualLight::Kind::directional);
}

double to_radiometric(LampUnit units, const AreaLight& light) {
  // A black surface of radiance L emits the power pi L A from its front.
  return units == LampUnit::watts ? 1 / (std::numbers::pi * light.area)
                                  : to_radiometric(units, true);
}

void take_lamps_as(Scene& scene, LampUnits::Kind units) {
  if (units == LampUnit::radiometric) return;
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

namespace {

constexpr double kHighest = 50, kUsual = 2.7;  // of rooms [m]
constexpr size_t kMostPoints = 16;
constexpr double kNone = std::numeric_limits<double>::infinity();

constexpr std::array kUnits{SceneUnit{"inches", 0.0254, 0}, SceneUnit{"centimetres", 0.01, 0},
                            SceneUnit{"millimetres", 0.001, 0}};

// Where people look from and lamps hang; of many every n-th.
std::vector<Vec3d> points_of(const Scene& scene) {
  std::vector<Vec3d> all, some;
  for (const Camera& camera : scene.cameras) all.push_back(camera.position);
  for (const PunctualLight& lamp : scene.lights)
    if (lamp.kind != PunctualLight::Kind::directional) all.push_back(lamp.position);
  const size_t step = (all.size() + kMostPoints - 1) / kMostPoints;
  for (size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

// How far the triangle is above the point, on the vertical through it; nothing if it is beside it.
std::optional<double> above(const Scene& scene, uint32_t triangle, const Vec3d& point) {
  std::array<Vec3d, 3> p;
  for (int c = 0; c < 3; ++c) p[c] = Vec3d(scene.vertex(triangle, c)) - point;
  std::array<double, 3> w;  // twice the areas that the point's shadow makes with each side
  for (size_t c = 0; c < 3; ++c) {
    const Vec3d &a = p[(c + 1) % 3], &b = p[(c + 2) % 3];
    w[c] = a.z * b.x - a.x * b.z;
  }
  const double sum = w[0] + w[1] + w[2];
  if (sum == 0 || w[0] * sum < 0 || w[1] * sum < 0 || w[2] * sum < 0) return {};
  return (w[0] * p[0].y + w[1] * p[1].y + w[2] * p[2].y) / sum;
}

double height_at(const Scene& scene, const Vec3d& point) {
  double up = kNone, down = kNone;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t)
    if (const auto height = above(scene, t, point))
      (*height > 0 ? up : down) = std::min(*height > 0 ? up : down, std::abs(*height));
  return up + down;
}

bool is_high(const Scene& scene) {
  double low = kNone, high = -kNone;
  for (const Vec3f& p : scene.positions) {
    low = std::min(low, static_cast<double>(p.y));
    high = std::max(high, static_cast<double>(p.y));
  }
  return high - low > kHighest * scene.frame.scale;
}

}  // namespace

std::optional<SceneUnit> unit_of(const Scene& scene) {
  if (!is_high(scene)) return {};
  std::vector<double> heights;
  for (const Vec3d& point : points_of(scene))
    if (const double height = height_at(scene, point) / scene.frame.scale; height < kNone)
      heights.push_back(height);
  if (heights.empty()) return {};
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  if (*middle < kHighest) return {};
  const auto misfit = [&](const SceneUnit& unit) {
    return std::abs(std::log(*middle * unit.metres / kUsual));
  };
  SceneUnit unit = *std::min_element(
      kUnits.begin(), kUnits.end(),
      [&](const SceneUnit& a, const SceneUnit& b) { return misfit(a) < misfit(b); });
  unit.height = *middle;
  return unit;
}

}  // namespace tdpt
