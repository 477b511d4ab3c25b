// EXT_lights_area: the triangles and the radiance of area lights.
#include <gtest/gtest.h>
#include <cmath>
#include <numbers>

#include "libcommon/base/error.h"
#include "libcommon/testing/files/sound_scene.h"
#include "libcommon/testing/scenes/materials.h"

namespace tdpt::testing::area_lights_test {

using Units = LampUnits::Kind;

constexpr double pi = std::numbers::pi;
constexpr const char* kBlender = "Khronos glTF Blender I/O v4.2.0";

/// A floor, 2 m wide.
GlbBuilder with_floor() {
  GlbBuilder b;
  const int p = b.floats({-1, 0, -1, -1, 0, 1, 1, 0, 1, 1, 0, -1}, 3);
  b.material({{"name", "floor"}});
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}, {"mode", 6}, {"material", 0}})}});
  return b;
}

void add_light(GlbBuilder& b, const Json& light, Json node = Json::object()) {
  Json& lights = b.json["extensions"]["EXT_lights_area"]["lights"];
  lights.push_back(light);
  node["extensions"]["EXT_lights_area"]["light"] = lights.size() - 1;
  b.node(node);
}

Scene read(const GlbBuilder& b) {
  Scene s = load(b);
  EXPECT_EQ(fault_of(s), "");
  return s;
}

/// The floor, which is the first two triangles, and a light.
Scene scene_with(const Json& light, const Json& node = Json::object()) {
  GlbBuilder b = with_floor();
  add_light(b, light, node);
  return read(b);
}

/// What the triangles of a light are, in metres.
struct Emitter {
  double area = 0;
  Vec3d normal, centre, low{1e9}, high{-1e9};
  size_t triangles = 0;
};
Emitter emitter_of(const Scene& s, const AreaLight& light) {
  Emitter e;
  for (uint32_t t = 0; t < s.triangles.size(); ++t) {
    if (s.triangles[t].material != light.material) continue;
    const TriangleShape shape = shape_of(s, t);
    const double area = shape.area / (s.frame.scale * s.frame.scale);
    Vec3d centre;
    for (int c = 0; c < 3; ++c) {
      const Vec3d p = s.frame.to_metres(Vec3d(s.vertex(t, c)));
      e.low = min(e.low, p), e.high = max(e.high, p), centre = centre + p / 3;
    }
    e.normal = e.normal + shape.normal * area;
    e.centre = e.centre + centre * area;
    e.area += area;
    ++e.triangles;
  }
  e.normal = e.normal / e.area, e.centre = e.centre / e.area;
  return e;
}
Emitter only_emitter_of(const Scene& s) {
  EXPECT_EQ(s.area_lights.size(), 1u);
  return s.area_lights.empty() ? Emitter() : emitter_of(s, s.area_lights[0]);
}

void expect_near(const Vec3d& a, const Vec3d& b) {
  EXPECT_LT(length(a - b), 1e-6) << a.x << " " << a.y << " " << a.z;
}

Rgb radiance(Scene s, Units units) {
  take_lamps_as(s, units);
  return s.materials[s.area_lights[0].material].emission;
}

TEST(AreaLights, ARectangleIsTwoBlackTrianglesThatFaceMinusZ) {
  const Scene s = scene_with({{"type", "rect"},
                              {"name", "panel"},
                              {"intensity", 20},
                              {"color", {1, 0.5, 0}},
                              {"size", 0.5},
                              {"rect", {{"aspect", 3}}}},
                             {{"translation", {0.25, 1, 0.5}}});
  const Emitter e = only_emitter_of(s);
  EXPECT_EQ(e.triangles, 2u);
  EXPECT_EQ(s.positions.size(), 8u);
  EXPECT_NEAR(e.area, 0.75, 1e-6);
  EXPECT_EQ(s.area_lights[0].area, 0.75);
  expect_near(e.normal, {0, 0, -1});
  expect_near(e.low, {0.25 - 0.75, 1 - 0.25, 0.5});
  expect_near(e.high, {0.25 + 0.75, 1 + 0.25, 0.5});
  const Material& m = s.materials[s.area_lights[0].material];
  EXPECT_EQ(m.name, "panel");
  EXPECT_EQ(m.base_color, Rgb(0.8f));
  EXPECT_EQ(m.emission, Rgb(20, 10, 0));
  EXPECT_FALSE(m.double_sided);
  EXPECT_TRUE(m.plain);
  EXPECT_EQ(s.warnings, Sentences{});
  EXPECT_TRUE(s.lights.empty());
}

// So that its power is right; the circumscribed circle is 0.08 per cent wider.
TEST(AreaLights, ADiskHasTheAreaOfADisk) {
  const Emitter e = only_emitter_of(
      scene_with({{"type", "disk"}, {"size", 0.5}}, {{"translation", {0.25, 1, 0.5}}}));
  EXPECT_EQ(e.triangles, 64u);
  EXPECT_NEAR(e.area, pi / 16, 1e-6);
  EXPECT_GT(std::abs(e.area - 16 * std::sin(pi / 32) / 8), 1e-4) << "twin: the inscribed polygon";
  expect_near(e.normal, {0, 0, -1});
  expect_near(e.centre, {0.25, 1, 0.5});
  EXPECT_NEAR(e.high.x - e.low.x, 0.5, 5e-4);
  EXPECT_NEAR(e.high.y - e.low.y, 0.5, 5e-4);
}

TEST(AreaLights, HaveDefaultsAndAloneMakeAScene) {
  GlbBuilder b;
  add_light(b, {{"type", "rect"}}, {{"name", "lamp"}});
  const Scene s = read(b);
  EXPECT_EQ(s.triangles.size(), 2u);
  EXPECT_NEAR(only_emitter_of(s).area, 1, 1e-6);
  const Material& m = s.materials[s.area_lights[0].material];
  EXPECT_EQ(m.emission, Rgb(1000));
  EXPECT_EQ(m.name, "lamp");
}

TEST(AreaLights, FollowTheirNodesButForShear) {
  const double h = std::sqrt(0.5);
  struct Case {
    Json node;
    double area;
    Vec3d normal, extent;
  };
  // A rectangle of 1 m by 0.5 m. The largest scale of its node counts in all directions, and it is
  // mirrored only where its axis is: as for spots, -Z of the node is where it is.
  const std::vector<Case> cases = {
      {{{"scale", {1, 1, 3}}}, 4.5, {0, 0, -1}, {3, 1.5, 0}},
      {{{"scale", {3, 0.5, 1}}}, 4.5, {0, 0, -1}, {3, 1.5, 0}},
      {{{"scale", {-3, 1, 1}}}, 4.5, {0, 0, -1}, {3, 1.5, 0}},
      {{{"scale", {1, -3, 2}}}, 4.5, {0, 0, -1}, {3, 1.5, 0}},
      {{{"scale", {-1, -1, 1}}}, 0.5, {0, 0, -1}, {1, 0.5, 0}},
      {{{"scale", {1, 1, -1}}}, 0.5, {0, 0, 1}, {1, 0.5, 0}},
      {{{"scale", {0, 2, 1}}}, 2, {0, 0, -1}, {2, 1, 0}},  // without an x it takes another
      {{{"rotation", {-h, 0, 0, h}}}, 0.5, {0, -1, 0}, {1, 0, 0.5}},
      // Below a parent that shears, a rectangle still has right angles.
      {{{"matrix", {1, 0, 0, 0, 0.75, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}},
       0.5 * (1 + 0.75 * 0.75),
       {0, 0, -1},
       {1.25, 0.625, 0}}};
  for (const Case& c : cases) {
    const Emitter e = only_emitter_of(
        scene_with({{"type", "rect"}, {"size", 0.5}, {"rect", {{"aspect", 2}}}}, c.node));
    EXPECT_NEAR(e.area, c.area, 1e-5) << c.node;
    expect_near(e.normal, c.normal);
    expect_near(e.high - e.low, c.extent);
  }
  EXPECT_EQ(scene_with({{"type", "rect"}}, {{"scale", {1, 1, 0}}}).warnings,
            Sentences{"lights with a flat transform are left out: nodes[1]"});
}

TEST(AreaLights, RadianceGoesByTheUnitsOfTheScenesLights) {
  const Json placed = {{"scale", {2, 2, 2}}};
  const Scene rect =
      scene_with({{"type", "rect"}, {"intensity", 683}, {"rect", {{"aspect", 3}}}}, placed);
  EXPECT_EQ(radiance(rect, Units::radiometric), Rgb(683));
  EXPECT_FLOAT_EQ(radiance(rect, Units::photometric).x, 1);
  EXPECT_FLOAT_EQ(radiance(rect, Units::watts).x, static_cast<float>(683 / (pi * 12)));
  const Scene disk = scene_with({{"type", "disk"}, {"intensity", 683}}, placed);
  EXPECT_EQ(radiance(disk, Units::radiometric), Rgb(683));
  EXPECT_FLOAT_EQ(radiance(disk, Units::photometric).y, 1);
  EXPECT_FLOAT_EQ(radiance(disk, Units::watts).z, static_cast<float>(683 / (pi * pi)));
  for (const Scene& s : {rect, disk})  // the power is what the file says
    EXPECT_NEAR(radiance(s, Units::watts).x * pi * only_emitter_of(s).area, 683, 1e-2);
}

TEST(AreaLights, UnitsGoByWhoWroteTheFileAndByOtherLamps) {
  const auto units = [](const Json& generator, const std::vector<Json>& lamps) {
    GlbBuilder b = with_floor();
    b.json["asset"]["generator"] = generator;
    add_light(b, {{"type", "rect"}, {"intensity", 40}});
    b.json["extensions"]["KHR_lights_punctual"]["lights"] = lamps;
    return read(b).lamp_units;
  };
  EXPECT_EQ(units("three.js", {}).kind, Units::radiometric);
  EXPECT_EQ(units("three.js", {}).reason, "");
  EXPECT_EQ(units(kBlender, {}).kind, Units::photometric);
  EXPECT_EQ(units(kBlender, {}).reason,
            "area lights are taken as nits, divided by 683 lm/W: so their extension defines them");
  // 100 W: the digits of points decide, those of area lights do not.
  EXPECT_EQ(units(kBlender, {{{"type", "point"}, {"intensity", 100}}}).kind, Units::watts);
}

TEST(AreaLights, StandBesideMeshesAndOtherLights) {
  GlbBuilder b;
  const int p = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  const int n = b.floats({0, 0, 1, 0.6f, 0, 0.8f, 0, 0.6f, 0.8f}, 3);
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}, {"NORMAL", n}}}})}});
  add_light(b, {{"type", "disk"}});
  add_light(b, {{"type", "rect"}}, {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({{{"type", "point"}}});
  b.json["extensionsRequired"] = {"EXT_lights_area"};
  const Scene s = read(b);
  ASSERT_EQ(s.materials.size(), 3u);
  EXPECT_EQ(s.lights.size(), 1u);
  EXPECT_EQ(s.materials[0].name, "default");
  EXPECT_EQ(s.area_lights[0].material, 1u);
  EXPECT_EQ(s.area_lights[1].material, 2u);
  EXPECT_EQ(s.normals.size(), s.positions.size());
  EXPECT_EQ(s.smooth.back(), 0);
}

TEST(AreaLights, DarkOnesAreNotThere) {
  for (const Json& light :
       {Json{{"type", "rect"}, {"intensity", 0}}, Json{{"type", "disk"}, {"color", {0, 0, 0}}}}) {
    const Scene s = scene_with(light);
    EXPECT_EQ(s.triangles.size(), 2u);
    EXPECT_TRUE(s.area_lights.empty());
    EXPECT_EQ(s.warnings, Sentences{});
  }
  EXPECT_EQ(scene_with({{"type", "rect"}, {"intensity", 1e-31}}).warnings,
            Sentences{"a radiance below 1e-30 counts as none: nodes[1]"});
}

TEST(AreaLights, PowerInATinyAreaIsRefused) {
  Scene s = scene_with({{"type", "rect"}, {"name", "dot"}, {"size", 1e-16}});
  s.path = "room.glb";
  take_lamps_as(s, Units::photometric);
  try {
    take_lamps_as(s, Units::watts);
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_TRUE(
        std::string(e.what()).starts_with("room.glb: area light \"dot\" of 1e-32 m2 emits"));
  }
}

}  // namespace tdpt::testing::area_lights_test
