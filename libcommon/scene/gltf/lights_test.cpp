// KHR_lights_punctual: position, direction, intensity and cones in the canonical frame.
#include <gtest/gtest.h>
#include <cmath>

#include "libcommon/scene/ies.h"
#include "libcommon/scene/lights.h"
#include "libcommon/testing/files/ies_text.h"
#include "libcommon/testing/scenes/materials.h"
#include "libcommon/testing/scenes/needs.h"

namespace tdpt::testing::lights_test {

using Kind = PunctualLight::Kind;

/// A triangle 2 `size` m long and a node for each light, with transform `placement`.
GlbBuilder lit_by(const std::vector<Json>& lights, Json placement = Json::object(), double size = 1,
                  const Json& generator = "") {
  GlbBuilder b;
  b.json["asset"]["generator"] = generator;
  const int p = b.floats({0, 0, 0, 2, 0, 0, 0, 1, 0}, 3);
  b.material(lambert(0.5, 0.5, 0.5));
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}, {"material", 0}})},
          {"scale", {size, size, size}}});
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = lights;
  for (size_t i = 0; i < lights.size(); ++i) {
    Json node = placement;
    node["extensions"]["KHR_lights_punctual"]["light"] = i;
    b.node(node);
  }
  return b;
}
Scene scene_with(const std::vector<Json>& lights, const Json& placement = Json::object(),
                 double size = 1, const Json& generator = "") {
  return load(lit_by(lights, placement, size, generator));
}

void expect_near(const Vec3d& a, const Vec3d& b) {
  EXPECT_LT(length(a - b), 1e-6) << a.x << " " << a.y << " " << a.z;
}

TEST(PunctualLights, PointsHaveAPlaceAndAnIntensity) {
  const Scene s =
      scene_with({{{"type", "point"}, {"name", "bulb"}, {"color", {1, 0.5, 0}}, {"intensity", 40}}},
                 {{"translation", {1, 2, 3}}, {"scale", {5, 5, 0}}});
  ASSERT_EQ(s.lights.size(), 1u);
  const PunctualLight& l = s.lights[0];
  EXPECT_EQ(l.kind, Kind::point);
  EXPECT_EQ(l.name, "bulb");
  expect_near(s.frame.to_metres(l.position), {1, 2, 3});
  EXPECT_EQ(l.intensity, Rgb(40, 20, 0));  // two metres long: the scale is 1
  EXPECT_EQ(needs_of(s), Sentences{"punctual lights"});
  EXPECT_EQ(s.warnings, Sentences{});
}

TEST(PunctualLights, IrradianceIsTheSameInBothFrames) {
  for (double size : {0.125, 1.0, 64.0}) {
    const Scene s =
        scene_with({{{"type", "point"}, {"intensity", 40}}}, {{"translation", {0, 0, 5}}}, size);
    const double metres = 5;
    const double canonical = length(s.lights[0].position - s.frame.to_canonical({0, 0, 0}));
    EXPECT_NEAR(s.lights[0].intensity.x / (canonical * canonical), 40 / (metres * metres), 1e-6);
  }
}

TEST(PunctualLights, DirectionalOnesShineAlongMinusZOfTheirNode) {
  const double h = std::sqrt(0.5);
  const Scene s = scene_with({{{"type", "directional"}, {"intensity", 3}}},
                             {{"rotation", {0, h, 0, h}}, {"scale", {1, 1, 7}}}, 64);
  EXPECT_EQ(s.lights[0].kind, Kind::directional);
  expect_near(s.lights[0].direction, {-1, 0, 0});
  EXPECT_EQ(s.lights[0].intensity, Rgb(3));  // W/m2 in any frame
}

TEST(PunctualLights, SpotsHaveCones) {
  const double pi = std::acos(-1.0);
  const Scene s = scene_with(
      {{{"type", "spot"}},
       {{"type", "spot"}, {"spot", {{"innerConeAngle", pi / 6}, {"outerConeAngle", pi / 3}}}},
       {{"type", "spot"}, {"spot", {{"outerConeAngle", 1.5707964}}}},
       {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.5}}}}},
      {{"translation", {0, 0, 2}}});
  ASSERT_EQ(s.lights.size(), 4u);
  EXPECT_EQ(s.lights[0].kind, Kind::spot);
  EXPECT_EQ(s.lights[0].intensity, Rgb(1));
  expect_near(s.lights[0].direction, {0, 0, -1});
  EXPECT_EQ(s.lights[0].cos_inner, 1);
  EXPECT_NEAR(s.lights[0].cos_outer, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(s.lights[1].cos_inner, std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(s.lights[1].cos_outer, 0.5, 1e-12);
  EXPECT_GE(s.lights[2].cos_outer, 0);  // pi / 2 rounded up
  // A sharp edge, as Blender writes a spot without blend.
  const LightSource source = LightSource::punctual(s.lights[3], 1);
  for (const auto& [angle, light] : {std::pair(0.0, 1.0f), {0.4999, 1.0f}, {0.5001, 0.0f}})
    EXPECT_EQ(source.emitted({}, {}, {std::sin(angle), 0, -std::cos(angle)}).x, light) << angle;
}

TEST(PunctualLights, UnitsGoByWhoWroteTheFile) {
  const std::vector<Json> lamps{{{"type", "point"}, {"intensity", 5435.141306588225}}};
  const auto by = [&](const Json& generator) {
    const Scene s = scene_with(lamps, Json::object(), 1, generator);
    return std::pair(s.by_blender, s.lamp_units.kind);
  };
  EXPECT_EQ(by("Khronos glTF Blender I/O v3.4.50"), std::pair(true, LampUnits::Kind::photometric));
  EXPECT_EQ(by("FBX2glTF"), std::pair(false, LampUnits::Kind::radiometric));
  EXPECT_EQ(by(7), std::pair(false, LampUnits::Kind::radiometric));
}

TEST(PunctualLights, DarkOnesAreSkippedAndANameMayBeTheNodes) {
  EXPECT_TRUE(
      scene_with({{{"type", "point"}, {"intensity", 0}}, {{"type", "spot"}, {"color", {0, 0, 0}}}})
          .lights.empty());
  EXPECT_EQ(scene_with({{{"type", "point"}}}, {{"name", "lamp"}}).lights[0].name, "lamp");
}

TEST(PunctualLights, BeyondSinglePrecisionAreRefused) {
  const auto fault = [](double intensity, double size) {
    return refusal(lit_by({{{"type", "point"}, {"intensity", intensity}}}, Json::object(), size));
  };
  const std::string place = "extensions.KHR_lights_punctual";
  EXPECT_EQ(fault(1e31, 1), place + ".lights[0]: has an intensity of 1e+31, expected at most 1e30");
  EXPECT_EQ(
      fault(1, 0x1p-60),
      place + ": an intensity of 1 W/sr is too much for a scene 1.734723475976807e-18 m long");
  EXPECT_EQ(fault(1, 0x1p60), place +
                                  ": an intensity of 1 W/sr is too little for a scene "
                                  "2.305843009213694e+18 m long");
  EXPECT_EQ(fault(1, 0x1p40), "");
}

const IesText kProfile{.multiplier = 3, .vertical = {0, 90}, .candela = {10, 4}};

/// Two nodes with the first of `lights`.
Scene luminaires(const Json& lights, const Json& extension, const TempFolder& folder,
                 const std::string& generator = "") {
  GlbBuilder b;
  b.json["asset"]["generator"] = generator;
  const int p = b.floats({0, 0, 0, 2, 0, 0, 0, 1, 0}, 3);
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}})}});
  b.json["extensions"]["EXT_lights_ies"]["lights"] = lights;
  const double h = std::sqrt(0.5);
  b.node({{"name", "a"},
          {"translation", {1, 2, 3}},
          {"rotation", {0, h, 0, h}},
          {"scale", {3, 1, 2}},
          {"extensions", {{"EXT_lights_ies", extension}}}});
  b.node({{"extensions", {{"EXT_lights_ies", extension}}}});
  return read_gltf(folder.write("scene.glb", b.glb()));
}

TEST(Luminaires, AimAlongMinusZOfTheirNodesAndTurnWithThem) {
  const TempFolder folder;
  const std::string uri = "data:;base64," + base64(kProfile.text());
  const Scene s = luminaires({{{"uri", uri}}},
                             {{"light", 0}, {"multiplier", 2}, {"color", {1, 0.5, 7}}}, folder);
  ASSERT_EQ(s.lights.size(), 2u);
  const PunctualLight& l = s.lights[0];
  EXPECT_EQ(l.name, "a");
  EXPECT_EQ(l.intensity, Rgb(60, 30, 60));  // colours beyond 1 are 1
  expect_near(s.frame.to_metres(l.position), {1, 2, 3});
  expect_near(l.direction, {-1, 0, 0});
  expect_near(l.across, {0, 0, -1});
  EXPECT_EQ(l.profile, s.lights[1].profile);
  EXPECT_EQ(needs_of(s), Sentences{"punctual lights"});
  EXPECT_EQ(s.lamp_units.kind, LampUnits::Kind::radiometric);
}

TEST(Luminaires, ProfilesLieBesideTheScene) {
  const TempFolder folder;
  const Json lights = {{{"uri", "my%20lamp.ies"}}, {{"uri", "nobody asks for it.ies"}}};
  EXPECT_THROW(luminaires(lights, {{"light", 0}}, folder), InputError);
  folder.write("my lamp.ies", kProfile.text());
  const Scene s = luminaires(lights, {{"light", 0}}, folder);
  EXPECT_EQ(s.lights.size(), 2u);
  ASSERT_EQ(s.files.size(), 1u);
  EXPECT_TRUE(s.files[0].ends_with("my lamp.ies"));
  IesText other = kProfile;
  other.candela[1] = 5;
  folder.write("my lamp.ies", other.text());
  EXPECT_NE(luminaires(lights, {{"light", 0}}, folder).hash, s.hash);
  folder.write("my lamp.ies", "TILT=NONE\n1 x");
  try {
    luminaires(lights, {{"light", 0}}, folder);
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_TRUE(std::string(e.what()).ends_with("my lamp.ies:2: has no number among its lumens"));
  }
}

// Candela are never watts, and Blender's surfaces are in W/m2/sr.
TEST(Luminaires, AreInCandela) {
  PunctualLight lamp;
  lamp.profile = std::make_shared<LightProfile>();
  using Units = LampUnits::Kind;
  EXPECT_EQ(to_radiometric(Units::radiometric, lamp), 1);
  EXPECT_EQ(to_radiometric(Units::photometric, lamp), 1 / LampUnits::kLumensPerWatt);
  EXPECT_EQ(to_radiometric(Units::watts, lamp), 1 / LampUnits::kLumensPerWatt);
  const TempFolder folder;
  const Json lights = {{{"uri", "data:;base64," + base64(kProfile.text())}}};
  EXPECT_EQ(
      luminaires(lights, {{"light", 0}}, folder, "Khronos glTF Blender I/O v4.2.0").lamp_units.kind,
      Units::photometric);
}

// The same text is read once.
TEST(Luminaires, DarkOnesAreSkipped) {
  const TempFolder folder;
  IesText dark = kProfile;
  dark.candela = {0, 0};
  EXPECT_TRUE(luminaires({{{"uri", "data:;base64," + base64(dark.text())}}}, {{"light", 0}}, folder)
                  .lights.empty());
  EXPECT_TRUE(luminaires({{{"uri", "data:;base64," + base64(kProfile.text())}}},
                         {{"light", 0}, {"multiplier", 0}}, folder)
                  .lights.empty());
}

}  // namespace tdpt::testing::lights_test
