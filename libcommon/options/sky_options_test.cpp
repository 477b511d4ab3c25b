#include "libcommon/options/sky_options.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/formats/picture.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::sky_options_test {

constexpr double kRadians = std::numbers::pi / 180;

// A scene without triangles and with one lamp of each kind.
Scene lamps() {
  Scene scene;
  scene.path = "room.glb";
  scene.hash = "1234";
  for (const auto kind : {PunctualLight::Kind::directional, PunctualLight::Kind::point,
                          PunctualLight::Kind::directional}) {
    PunctualLight lamp;
    lamp.kind = kind;
    lamp.direction = {0.6, -0.8, 0};
    lamp.intensity = Rgb(5, 4, 3);
    scene.lights.push_back(lamp);
  }
  return scene;
}

struct Added {
  Scene scene;
  std::vector<cli::Common::Input> files;
  cli::Common common;
  explicit Added(const SkyArguments& a, Scene s = lamps(), const std::string& output = "a.exr")
      : scene(std::move(s)) {
    common.quiet = true;
    common.dependencies = "a.d";
    common.output = output;
    common.outputs = {{"-o", output}};
    add_sky(scene, a, common, files);
  }
};
SkyArguments environment(const std::string& value, std::optional<double> rotation = {},
                         std::optional<double> scale = {}, double sun_angle = 0) {
  return {value, rotation, scale, sun_angle};
}

// A map in a file; its first texel differs from the others.
struct File {
  testing::TempFolder folder;
  std::string bytes, path;
  explicit File(float first = 2) {
    ExrFile exr;
    exr.picture = {4, 2, std::vector<Rgb>(8, Rgb(1))};
    exr.picture.pixels[0] = Rgb(first);
    bytes = exr_bytes(exr);
    path = folder.write("sky.exr", bytes);
  }
};

TEST(SkyOptions, WithoutThemNothingChanges) {
  for (const Added& a : {Added({}), Added(environment("none"))}) {
    EXPECT_FALSE(a.scene.sky);
    EXPECT_EQ(a.scene.lights.size(), 3u);
    EXPECT_EQ(a.scene.identity(), "1234");
    EXPECT_TRUE(a.files.empty());
  }
}

// The messages on stderr during the call.
std::string said(const std::function<void(const cli::Common&)>& act) {
  cli::Common common;
  ::testing::internal::CaptureStderr();
  act(common);
  return ::testing::internal::GetCapturedStderr();
}
Scene lamps_of_blender() {
  Scene scene = lamps();
  scene.lamp_units = {LampUnits::Kind::photometric, "lamps are candela."};
  return scene;
}
struct Taken {
  Scene scene;
  std::string note;
  Taken(Scene s, const std::string& units, const std::string& environment = "")
      : scene(std::move(s)) {
    note = said([&](const cli::Common& common) {
      std::vector<cli::Common::Input> files;
      add_sky(scene, {environment, {}, {}, 0, units}, common, files);
    });
  }
};

TEST(SkyOptions, UnitsAreThoseOfTheFileUnlessGiven) {
  const Taken as_is(lamps(), "auto"), blender(lamps_of_blender(), "auto");
  EXPECT_EQ(as_is.scene.lights[0].intensity, Rgb(5, 4, 3));
  EXPECT_EQ(as_is.note, "");
  for (const PunctualLight& lamp : blender.scene.lights)
    EXPECT_FLOAT_EQ(lamp.intensity.x, 5 / 683.f);
  EXPECT_NE(blender.note.find("lamps are candela."), std::string::npos);
  EXPECT_EQ(blender.scene.identity(), "1234");
  const Taken given(lamps_of_blender(), "radiometric");
  EXPECT_EQ(given.scene.lights[0].intensity, Rgb(5, 4, 3));
  EXPECT_EQ(given.note, "");
  const Taken watts(lamps(), "watts");
  EXPECT_EQ(watts.scene.lights[0].intensity, Rgb(5, 4, 3));  // a sun
  EXPECT_FLOAT_EQ(watts.scene.lights[1].intensity.x,
                  static_cast<float>(5 / (4 * std::numbers::pi)));
}

TEST(SkyOptions, OtherUnitsMakeAnotherScene) {
  EXPECT_EQ(Taken(lamps_of_blender(), "photometric").scene.identity(), "1234");
  EXPECT_NE(Taken(lamps_of_blender(), "radiometric").scene.identity(), "1234");
  const std::string watts = Taken(lamps_of_blender(), "watts").scene.identity();
  EXPECT_NE(watts, "1234");
  EXPECT_TRUE(lamps().is_scene_of(watts));
  const std::string sky = Taken(lamps_of_blender(), "auto", "1,1,1").scene.identity();
  EXPECT_EQ(Taken(lamps(), "auto", "1,1,1").scene.identity(), sky);
  EXPECT_NE(Taken(lamps_of_blender(), "radiometric", "1,1,1").scene.identity(), sky);
}

// An area light of radiance 1 and 2 m2, beside the surfaces that are there.
void add_area_light(Scene& scene) {
  scene.area_lights.push_back({static_cast<uint32_t>(scene.materials.size()), 2});
  scene.materials.emplace_back().emission = Rgb(1);
}

TEST(SkyOptions, AreaLightsAreConverted) {
  Scene alone;
  alone.hash = "1234";
  alone.lamp_units = {LampUnits::Kind::photometric, ""};
  add_area_light(alone);
  EXPECT_FLOAT_EQ(Taken(alone, "auto").scene.materials[0].emission.x, 1 / 683.f);
  EXPECT_EQ(Taken(alone, "radiometric").scene.materials[0].emission.x, 1);
  EXPECT_EQ(Taken(alone, "photometric").scene.identity(), "1234");
  EXPECT_NE(Taken(alone, "watts").scene.identity(), "1234");
}

TEST(SkyOptions, OneColour) {
  const Added a(environment("0.5,1,2e3", 0, 3));
  ASSERT_TRUE(a.scene.sky && a.scene.sky->one_colour());
  EXPECT_EQ(a.scene.sky->radiance({0, 1, 0}), Rgb(1.5f, 3, 6000));
  EXPECT_EQ(a.scene.lights.size(), 3u);
  EXPECT_TRUE(a.files.empty());
}

TEST(SkyOptions, AFileIsAnInput) {
  const File file;
  const Added a(environment(file.path, 90, 0.5));
  ASSERT_EQ(a.files.size(), 1u);
  EXPECT_EQ(a.files[0].path, file.path);
  EXPECT_EQ(a.files[0].hash, content_hash(file.bytes));
  EXPECT_EQ(a.scene.sky->map().texels[0], Rgb(1));
  EXPECT_EQ(a.scene.sky->map().texels[1], Rgb(0.5f));
  // The texel at the seam, behind the camera, moves by a quarter turn.
  const Vec3d w = a.scene.sky->towards(0.5, 0.5);
  EXPECT_EQ(a.scene.sky->radiance(w), Rgb(1));
}

// The case environment-usage has the rest.
TEST(SkyOptions, WhatIsNoColourIsRefused) {
  for (const char* value : {"1,2", "1,2,3,4", "-1,1,1", "1,nan,1", "inf,1,1", "1,,1", "1,2,x",
                            "1e31,0,0", "3", ",,", "0,0,0"})
    EXPECT_THROW(Added(environment(value)), UsageError) << value;
  for (const char* file : {"a,b.exr", "./1,2,3", "./none"})
    EXPECT_THROW(Added(environment(file)), InputError) << file;
  EXPECT_THROW(Added(environment("1e25,1,1", 0, 1e7)), UsageError) << "beyond 1e30";
}

// A scene with its own environment, a file if `file`.
Scene with_own(const std::string& environment, std::optional<double> rotation = {},
               std::optional<double> scale = {}, const std::string& file = "") {
  Scene scene = lamps();
  scene.defaults.place = "scenes[0].extras";
  scene.defaults.environment = environment;
  scene.defaults.environment_file = file;
  scene.defaults.rotation = rotation;
  scene.defaults.scale = scale;
  return scene;
}

TEST(SkyOptions, TheScenesOwnEnvironmentIsTheDefault) {
  const Scene scene = with_own("1,2,3", 40, 5);
  const auto taken = [&](const SkyArguments& a) {
    const TakenSky sky = sky_of(scene, a);
    return fmt::format("{} {} {}", sky.environment, sky.rotation, sky.scale);
  };
  EXPECT_EQ(taken({}), "1,2,3 40 5");
  EXPECT_EQ(taken(environment("", 0)), "1,2,3 0 5") << "replaces the scene's";
  EXPECT_EQ(taken(environment("", {}, 1)), "1,2,3 40 1");
  EXPECT_EQ(taken(environment("4,4,4")), "4,4,4 0 1") << "the others belong to the scene's";
  EXPECT_EQ(taken(environment("4,4,4", 7, 2)), "4,4,4 7 2");
  EXPECT_EQ(taken(environment("none")), " 0 1");
  const TakenSky plain = sky_of(with_own("1,2,3"), {});
  EXPECT_EQ(plain.rotation, 0);
  EXPECT_EQ(plain.scale, 1);
  EXPECT_TRUE(sky_of(with_own("none"), {}).environment.empty());
  EXPECT_EQ(sky_of(with_own("1%2C2.x", {}, {}, "1,2.x"), {}).environment, "./1,2.x")
      << "a file stays one";
}

TEST(SkyOptions, TheScenesOwnFileIsAnInputLikeOneOfTheCommandLine) {
  const File file;
  const Added own({}, with_own("sky.exr", 90, 0.5, file.path)),
      given(environment(file.path, 90, 0.5));
  ASSERT_EQ(own.files.size(), 1u);
  EXPECT_EQ(own.files[0].path, file.path);
  EXPECT_EQ(own.files[0].hash, given.files.at(0).hash);
  EXPECT_EQ(own.scene.identity(), given.scene.identity());
  EXPECT_EQ(own.scene.sky->map().texels, given.scene.sky->map().texels);
  EXPECT_EQ(own.scene.sky->turn_cos(), given.scene.sky->turn_cos());
  EXPECT_NE(own.common.dependency_rule().find(file.path), std::string::npos);
  EXPECT_THROW(Added({}, with_own("sky.exr", {}, {}, file.path), file.path), UsageError)
      << "the output is the input";
}

TEST(SkyOptions, WhatBlenderLeavesOutIsToldWhereThereIsNoLight) {
  Scene scene;
  const auto note = [&] {
    return said([&](const cli::Common& common) { note_lost_light(scene, common); });
  };
  EXPECT_EQ(note(), "") << "nobody knows who wrote it";
  scene.by_blender = true;
  EXPECT_NE(note().find("Include > Punctual Lights"), std::string::npos);
  scene.materials.emplace_back().emission = Rgb(1);
  EXPECT_EQ(note(), "");
  scene.materials.clear();
  scene.lights.resize(1);
  EXPECT_EQ(note(), "");
  scene.lights.clear();
  add_area_light(scene);
  EXPECT_EQ(note(), "");
  scene.materials.clear();
  scene.area_lights.clear();
  scene.sky = std::make_shared<Sky>(Sky::Map{1, 1, {Rgb(1)}}, 0);
  EXPECT_EQ(note(), "");
}

TEST(SkyOptions, DirectionalLampsBecomeSunsOfTheSameIrradiance) {
  for (const double angle : {0.01, 0.53, 60.0}) {
    const Added a(environment("", {}, {}, angle));
    ASSERT_EQ(a.scene.lights.size(), 1u);
    EXPECT_EQ(a.scene.lights[0].kind, PunctualLight::Kind::point);
    ASSERT_EQ(a.scene.sky->suns().size(), 2u);
    const Sky::Sun& sun = a.scene.sky->suns()[0];
    EXPECT_EQ(sun.towards, Vec3d(-0.6, 0.8, 0));
    EXPECT_DOUBLE_EQ(sun.half_angle, 0.5 * angle * kRadians);
    // Integral of the cosine over the disc, by its projection.
    const double projected = std::numbers::pi * std::pow(std::sin(sun.half_angle), 2);
    EXPECT_NEAR(sun.radiance.x * projected, 5, 1e-5);
    EXPECT_NEAR(sun.radiance.z * projected, 3, 1e-5);
    EXPECT_TRUE(a.scene.sky->map().texels.empty());
  }
}

// Files belong to another scene if the light comes from elsewhere, not if it is brighter.
TEST(SkyOptions, IdentityIsOfWhereTheLightComesFrom) {
  const File file, other(3);
  const auto identity = [](const SkyArguments& a) { return Added(a).scene.identity(); };
  const std::string one = identity(environment(file.path));
  EXPECT_TRUE(one.starts_with("1234+"));
  EXPECT_EQ(one, identity(environment(file.path, 0, 7)));
  EXPECT_EQ(one, identity(environment(file.path, 360)));
  EXPECT_NE(one, identity(environment(file.path, 10)));
  EXPECT_NE(one, identity(environment(other.path)));
  EXPECT_NE(one, identity(environment(file.path, 0, 1, 0.5)));
  EXPECT_NE(identity(environment(file.path, 0, 1, 1)), identity(environment(file.path, 0, 1, 0.5)));
  EXPECT_EQ(identity(environment("1,1,1", 10)), identity(environment("1,1,1")));
  EXPECT_NE(identity(environment("1,1,1")), identity(environment("1,1,2")));
  EXPECT_EQ(identity(environment("1,1,1")), identity(environment("1.0,1e0,1", 0, 2)));
}

}  // namespace tdpt::sky_options_test
