// Units of a file's lamps, inferred from the exporter and from the digits of the numbers.
// The factors were measured: Blender 3.4.1's exports in each of its modes against its own pictures,
// doc/scenes.md.
#include "libcommon/scene/units.h"

#include <gtest/gtest.h>
#include <cmath>
#include <numbers>
#include <string>

#include "libcommon/scene/scene.h"

namespace tdpt::units_test {

using Kind = LampUnits::Kind;
constexpr const char* kNew = "Khronos glTF Blender I/O v3.4.50";
constexpr double kPi = std::numbers::pi;

// What Blender's exporter writes for a lamp of so many watts, or a sun of so many W/m2; settings
// are in single precision.
std::vector<LampNumber> points(Kind mode, const std::vector<float>& watts) {
  std::vector<LampNumber> lamps;
  for (const float w : watts)
    lamps.push_back({mode == Kind::watts         ? double{w}
                     : mode == Kind::photometric ? w / (4 * kPi) * 683
                                                 : w / (4 * kPi),
                     false});
  return lamps;
}
std::vector<LampNumber> suns(bool photometric, const std::vector<float>& settings) {
  std::vector<LampNumber> lamps;
  for (const float s : settings) lamps.push_back({photometric ? 683.0 * s : s, true});
  return lamps;
}
Kind kind(const char* generator, const std::vector<LampNumber>& lamps) {
  return lamp_units_of(generator, lamps).kind;
}

TEST(LampUnits, GoByWhoWroteTheFileAndByDigits) {
  struct Case {
    const char* generator;
    std::vector<LampNumber> lamps;
    Kind kind;
    const char* reason;  ///< a part of it; "" if there is none
  };
  const char *by_default = "by default", *told_otherwise = "unless told otherwise";
  const std::vector<Case> cases = {
      {"", {{37.3, false}}, Kind::radiometric, ""},
      {"glTF-Transform v4.1.0", {{37.3, false}}, Kind::radiometric, ""},
      {"Khronos glTF Blender I/O", {{37.3, false}}, Kind::radiometric, ""},
      {"glTF-Transform v4.1.0", points(Kind::photometric, {60}), Kind::radiometric,
       "--set light-units=photometric would divide them by 683 lm/W"},
      {"Khronos glTF Blender I/O v3.4.40", suns(true, {3, 0.7f}), Kind::photometric, by_default},
      {"Khronos glTF Blender I/O v5.0.21", points(Kind::photometric, {100, 12.5f, 0.1f}),
       Kind::photometric, by_default},
      {kNew, points(Kind::radiometric, {100, 12.5f}), Kind::radiometric, "in its unitless mode"},
      {kNew, suns(false, {3, 0.7f}), Kind::radiometric, "in its unitless mode"},
      {kNew, points(Kind::watts, {100, 12.5f}), Kind::watts, "in its raw mode"},
      // Digits that tell nothing leave the default.
      {kNew, points(Kind::radiometric, {37.123456f}), Kind::photometric, told_otherwise},
      {kNew, points(Kind::watts, {37.123456f}), Kind::photometric, told_otherwise},
      {kNew, {{0.0, false}, {1e300, false}, {1e-320, true}}, Kind::photometric, told_otherwise},
      // 683 times a sun of 1 is also a number that a person might type.
      {kNew, suns(true, {1}), Kind::photometric, ""}};
  for (const Case& c : cases) {
    const LampUnits units = lamp_units_of(c.generator, c.lamps);
    EXPECT_EQ(units.kind, c.kind) << c.generator << ' ' << units.reason;
    EXPECT_NE(units.reason.find(c.reason), std::string::npos) << units.reason;
    EXPECT_TRUE(*c.reason || units.kind == Kind::photometric || units.reason.empty());
  }
}

TEST(LampUnits, TheFewestDigitsOfMostLampsDecide) {
  auto lamps = points(Kind::radiometric, {100, 60, 37.123456f});
  EXPECT_EQ(kind(kNew, lamps), Kind::radiometric);
  lamps.push_back({12.345678, false});
  EXPECT_EQ(kind(kNew, lamps), Kind::photometric);
}

TEST(LampUnits, RandomNumbersSeldomLookTyped) {
  int told = 0;
  for (int i = 1; i <= 20000; ++i)
    told +=
        kind(kNew, {{std::exp(std::fmod(i * 0.6180339887, 1.0) * 10), false}}) != Kind::photometric;
  EXPECT_LT(told, 40);  // expected: a thousandth of them for each of two modes
}

TEST(LampUnits, ALampOfAWattIsTheSameInAllOfThem) {
  for (const Kind mode : {Kind::radiometric, Kind::photometric, Kind::watts}) {
    const LampNumber lamp = points(mode, {100})[0];
    EXPECT_NEAR(lamp.value * to_radiometric(mode, false), 100 / (4 * kPi), 1e-9);
  }
  EXPECT_NEAR(683 * to_radiometric(Kind::photometric, true), 1, 1e-12);
  EXPECT_EQ(to_radiometric(Kind::watts, true), 1);
}

TEST(LampUnits, LampsAreTakenByTheirKind) {
  Scene scene;
  for (const auto kind :
       {PunctualLight::Kind::point, PunctualLight::Kind::spot, PunctualLight::Kind::directional}) {
    PunctualLight lamp;
    lamp.kind = kind;
    lamp.intensity = Rgb(8, 4, 0);
    scene.lights.push_back(lamp);
  }
  Scene watts = scene;
  take_lamps_as(watts, Kind::watts);
  for (const size_t lamp : {0, 1})
    EXPECT_FLOAT_EQ(watts.lights[lamp].intensity.y, 1 / static_cast<float>(kPi));
  EXPECT_EQ(watts.lights[2].intensity, Rgb(8, 4, 0));
  Scene photometric = scene;
  take_lamps_as(photometric, Kind::photometric);
  for (const PunctualLight& lamp : photometric.lights) EXPECT_FLOAT_EQ(lamp.intensity.x, 8 / 683.f);
  take_lamps_as(scene, Kind::radiometric);
  for (const PunctualLight& lamp : scene.lights) EXPECT_EQ(lamp.intensity, Rgb(8, 4, 0));
}

// A floor and ceilings above it, each over a place on the x axis with a camera 1.6 m high; all
// times `scale`.
Scene rooms(const std::vector<double>& heights, double scale) {
  Scene scene;
  scene.frame.scale = 1 / (1000 * scale);  // canonical: within [-1, 1]
  const auto add = [&](double x, double y) {
    const auto first = static_cast<uint32_t>(scene.positions.size());
    for (const auto& [dx, dz] : {std::pair(-2, -2), {2, -2}, {0, 3}})
      scene.positions.push_back(
          Vec3f(scene.frame.to_canonical(Vec3d{x + dx, y, 1.0 * dz} * scale)));
    scene.triangles.push_back({{first, first + 1, first + 2}, 0});
  };
  for (size_t i = 0; i < heights.size(); ++i) {
    const double x = 10.0 * static_cast<double>(i);
    add(x, 0);
    if (heights[i] > 0) add(x, heights[i]);
    scene.cameras.emplace_back().position = scene.frame.to_canonical(Vec3d{x, 1.6, 0} * scale);
  }
  return scene;
}

std::string unit(const std::vector<double>& heights, double scale) {
  const auto told = unit_of(rooms(heights, scale));
  return told ? told->name : "metres";
}

TEST(scene_unit, is_told_by_rooms_from_low_to_high) {
  for (const double height : {1.8, 2.2, 2.7, 3.5, 4.2}) {
    EXPECT_EQ(unit({height}, 100), "centimetres") << height;
    EXPECT_EQ(unit({height}, 39.37), "inches") << height;
    EXPECT_EQ(unit({height}, 1000), "millimetres") << height;
  }
}

TEST(scene_unit, is_not_told_of_metres_nor_without_ceilings) {
  for (const double height : {1.8, 2.7, 12.0, 40.0}) EXPECT_EQ(unit({height}, 1), "metres");
  EXPECT_EQ(unit({0}, 100), "metres") << "no ceiling";
  Scene scene = rooms({2.7}, 100);
  scene.cameras.clear();
  EXPECT_FALSE(unit_of(scene)) << "nobody is in it";
}

TEST(scene_unit, is_not_changed_by_one_hall_or_shelf) {
  EXPECT_EQ(unit({2.5, 80, 3}, 1), "metres");
  EXPECT_EQ(unit({2.5, 0.4, 3}, 100), "centimetres") << "one camera stands under a shelf";
}

}  // namespace tdpt::units_test
