#include "tools/tdpt-import/tungsten/tungsten.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::foreign::tungsten_test {

using std::numbers::pi;

struct Read {
  Described scene;
  std::vector<std::string> losses;
};

Read read(const std::string& json) {
  const testing::TempFolder folder;
  folder.write("room.obj", "v 0 0 0\nv 2 0 0\nv 0 2 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
  folder.write("wood.png", "not decoded here");
  Source source(folder.write("scene.json", json));
  Read r{read_tungsten(source), {}};
  source.lose_unread();
  for (const auto& loss : source.losses())
    r.losses.push_back(loss.first.where + ": " + loss.sentence);
  return r;
}

std::string complaint(const std::string& json) {
  try {
    read(json);
    return "";
  } catch (const InputError& e) {
    const std::string what = e.what();
    return what.substr(what.find("scene.json") + 11);
  }
}

std::string with(const std::string& primitive, const std::string& bsdfs = "[]") {
  return R"({"bsdfs": )" + bsdfs + R"(, "primitives": [)" + primitive + "]}";
}

Material material(const std::string& bsdf) {
  const Read r = read(with(R"({"type": "quad", "bsdf": )" + bsdf + "}"));
  return r.scene.materials.at(r.scene.shapes.at(0).material);
}

void expect_near(const Vec3d& a, const Vec3d& b) {
  EXPECT_NEAR(a.x, b.x, 1e-9);
  EXPECT_NEAR(a.y, b.y, 1e-9);
  EXPECT_NEAR(a.z, b.z, 1e-9);
}

// Where a mesh's own +z, its front, points.
Vec3d front(const Shape& s) {
  const Affine& m = s.to_world;
  const Vec3d n = normalize(cross(m.x, m.y)) * (m.mirrors() ? -1.0 : 1.0);
  return s.turned ? -n : n;
}

TEST(Tungsten, FieldOfViewIsHorizontal) {
  const Camera c = read(R"({"primitives": [], "camera": {"fov": 90, "resolution": [200, 100],
    "transform": {"position": [1, 2, 3], "look_at": [1, 2, 0], "up": [0, 1, 0]}}})")
                       .scene.cameras.at(0);
  EXPECT_NEAR(c.yfov, 2 * std::atan(0.5), 1e-12);
  EXPECT_EQ(c.width, 200);
  EXPECT_EQ(c.height, 100);
  expect_near(c.to_world.t, {1, 2, 3});
  expect_near(c.to_world.z, {0, 0, 1});  // looks along -z
  expect_near(c.to_world.y, {0, 1, 0});
  expect_near(c.to_world.x, {1, 0, 0});
}

TEST(Tungsten, QuadsFaceTheirYAxis) {
  const Shape plain = read(with(R"({"type": "quad"})")).scene.shapes.at(0);
  expect_near(front(plain), {0, 1, 0});
  const auto turned = R"({"type": "quad", "transform": {"rotation": [90, 0, 0]}})";
  expect_near(front(read(with(turned)).scene.shapes.at(0)), {0, 0, 1});
  // The front is taken from the placed edges, so a mirror turns it.
  const auto mirrored = R"({"type": "quad", "transform": {"scale": [1, -1, 1]}})";
  expect_near(front(read(with(mirrored)).scene.shapes.at(0)), {0, 1, 0});
}

TEST(Tungsten, RotationsAreAboutYThenXThenZ) {
  const auto shape = [](const char* rotation) {
    return read(with(std::string(R"({"type": "cube", "transform": {"rotation": )") + rotation +
                     "}}"))
        .scene.shapes.at(0);
  };
  expect_near(shape("[0, 90, 0]").to_world.x * 2.0, {0, 0, 1});
  expect_near(shape("[0, 0, 90]").to_world.x * 2.0, {0, 1, 0});
  expect_near(shape("[90, 90, 0]").to_world.y * 2.0, {-1, 0, 0});
}

TEST(Tungsten, PowerIsSpreadOverTheArea) {
  const Read r = read(with(R"({"type": "quad", "power": 12, "transform": {"scale": [2, 1, 3]}})"));
  ASSERT_TRUE(r.scene.shapes.at(0).emission);
  EXPECT_NEAR(r.scene.shapes[0].emission->radiance.factor.x, 12 / (6 * pi), 1e-6);
  EXPECT_FALSE(r.scene.shapes[0].emission->both_sides);
  const Read point = read(with(R"({"type": "point", "power": 12})"));
  EXPECT_NEAR(point.scene.lamps.at(0).intensity.x, 12 / (4 * pi), 1e-6);
}

TEST(Tungsten, SkyIsSeenAlongPlusXInTheMiddle) {
  const Read r = read(with(R"({"type": "infinite_sphere", "emission": "wood.png"})"));
  ASSERT_TRUE(r.scene.sky);
  expect_near(r.scene.sky->to_map.vector({1, 0, 0}), {0, 0, -1});  // u = 1/2
  expect_near(r.scene.sky->to_map.vector({0, 0, 1}), {1, 0, 0});   // u = 3/4
  expect_near(r.scene.sky->to_map.vector({0, 1, 0}), {0, 1, 0});
  const Read turned = read(with(R"({"type": "infinite_sphere", "emission": 2,
    "transform": {"rotation": [0, 90, 0]}})"));
  EXPECT_EQ(turned.scene.sky->colour.y, 2);
  expect_near(turned.scene.sky->to_map.vector({0, 0, 1}), {0, 0, -1});
}

TEST(Tungsten, SunShinesDownItsYAxisAndSaysHowWideItIs) {
  const Read r = read(with(R"({"type": "infinite_sphere_cap", "power": 10, "cap_angle": 5})"));
  const Lamp& sun = r.scene.lamps.at(0);
  expect_near(sun.towards, {0, -1, 0});
  const double c = std::cos(5 * pi / 180);
  EXPECT_NEAR(sun.intensity.x, 10 * (1 - c * c) / (2 * (1 - c)), 1e-5);
  ASSERT_EQ(r.losses.size(), 1u);
  EXPECT_NE(r.losses[0].find("--sun-angle 10"), std::string::npos);
}

TEST(Tungsten, SurfacesKeepTheirMeaning) {
  EXPECT_EQ(material(R"({"type": "lambert", "albedo": 0.5})").specular, 0);
  const Material mirror = material(R"({"type": "mirror", "albedo": 0.9})");
  EXPECT_EQ(mirror.metallic, 1);
  EXPECT_EQ(mirror.roughness.factor, 0);
  const Material metal =
      material(R"({"type": "rough_conductor", "material": "Al", "roughness": 0.25})");
  ASSERT_TRUE(metal.eta_k);
  EXPECT_NEAR(metal.roughness.factor, 0.5, 1e-6);
  EXPECT_NEAR(metal.base.factor.x, 0.931, 0.01);
  const Material glass = material(R"({"type": "dielectric", "ior": 1.33})");
  EXPECT_TRUE(glass.solid);
  EXPECT_NEAR(glass.ior, 1.33, 1e-6);
  const Material sheet = material(R"({"type": "thinsheet", "ior": 1.5})");
  EXPECT_FALSE(sheet.solid);
  const double f = std::pow((sheet.ior - 1) / (sheet.ior + 1), 2);
  EXPECT_NEAR(f, 0.08 / 1.04, 1e-6);  // both sides of a sheet that reflect 4 per cent each
  EXPECT_EQ(material(R"({"type": "null"})").base.factor.x, 0);
  EXPECT_EQ(material(R"("null")").base.factor.x, 0);
}

// A white base stays white, a grey one gets darker: the light inside is coloured more than once.
TEST(Tungsten, PlasticsAreColouredMoreThanOnce) {
  EXPECT_NEAR(material(R"({"type": "plastic", "albedo": 1})").base.factor.x, 1, 1e-5);
  EXPECT_NEAR(material(R"({"type": "plastic", "albedo": 0.5, "ior": 1.5})").base.factor.x, 0.2876,
              2e-3);
}

TEST(Tungsten, ChecksStartWithOffAtTheLowerLeft) {
  const Read r = read(with(R"({"type": "quad", "bsdf": {"type": "lambert", "albedo":
    {"type": "checker", "on_color": 0.9, "off_color": 0.1, "res_u": 4, "res_v": 6}}})"));
  const Texture& t = *r.scene.materials.at(0).base.texture;
  const Image& image = r.scene.images.at(t.image);
  // The lower left corner of the surface is (0, 1) in glTF's coordinates.
  const double u = t.map[0] * 0.01 + t.map[2], v = t.map[4] * 0.99 + t.map[5];
  const auto texel = [&](double a, double b) {
    const auto cell = [](double x) { return static_cast<size_t>((x - std::floor(x)) * 2); };
    return image.texels[cell(b) * 2 + cell(a)].x;
  };
  EXPECT_NEAR(texel(u, v), 0.1, 1e-6);
  EXPECT_NEAR(texel(u + 0.5, v), 0.9, 1e-6);
  EXPECT_NEAR(texel(u, v - 0.5), 0.9, 1e-6);
}

TEST(Tungsten, SmoothIsTold) {
  const Read r = read(with(R"({"type": "mesh", "file": "room.obj", "smooth": true},
                              {"type": "mesh", "file": "room.obj", "smooth": false},
                              {"type": "mesh", "file": "room.obj", "smooth": false})"));
  EXPECT_EQ(r.scene.meshes.size(), 2u);
  EXPECT_FALSE(r.scene.meshes[r.scene.shapes[0].mesh].normals.empty());
  EXPECT_TRUE(r.scene.meshes[r.scene.shapes[1].mesh].normals.empty());
  EXPECT_EQ(r.scene.shapes[1].mesh, r.scene.shapes[2].mesh);
}

TEST(Tungsten, WhatIsLostIsNamedWithItsPlace) {
  const Read r = read(with(R"({"type": "curves", "file": "x"}, {"type": "quad", "int_medium": "fog",
    "colour": 3, "bsdf": {"type": "velvet"}})"));
  ASSERT_EQ(r.losses.size(), 4u);
  EXPECT_EQ(r.losses[0], "primitives[0]: primitives of type \"curves\" are not read and left out");
  EXPECT_EQ(r.losses[1], "primitives[1]: media (fog, absorption, scattering) are left out");
  EXPECT_NE(r.losses[2].find("primitives[1].bsdf: surfaces of type \"velvet\""), std::string::npos);
  EXPECT_EQ(r.losses[3], "primitives[1]: \"colour\" of a quad is not read");
}

TEST(Tungsten, ErrorsNameTheirPlace) {
  EXPECT_EQ(complaint("[]"), " is no Tungsten scene: expected an object");
  EXPECT_EQ(complaint("{}"), " is no Tungsten scene: expected an array \"primitives\"");
  EXPECT_NE(complaint("{\n \"a\": ]").find("line 2, column 7"), std::string::npos);
  EXPECT_EQ(complaint(with(R"({"type": "quad", "transform": [1, 2]})")),
            "primitives[0].transform: is a matrix of 2 numbers, expected 16");
  EXPECT_EQ(complaint(with(R"({"type": "quad", "bsdf": "brick"})")),
            "primitives[0].bsdf: \"brick\" is no surface of the scene");
  EXPECT_EQ(complaint(with(R"({"type": "mesh"})")), "primitives[0]: has no \"file\"");
  EXPECT_EQ(complaint(with(R"({"type": "quad", "emission": "a b"})")),
            "primitives[0].emission: \"a b\" cannot be opened: No such file or directory");
  EXPECT_EQ(complaint(with(R"({"type": "mesh", "file": "../room.obj"})")),
            "primitives[0].file: \"../room.obj\" is not a file in the scene's folder, which is all "
            "that is read");
  EXPECT_EQ(complaint(with(R"({"type": "quad", "bsdf": {"type": "mixed", "bsdf0": "a"}})",
                           R"([{"name": "a", "type": "smooth_coat", "substrate": "a"}])")),
            "bsdfs[0].substrate: is nested too deeply, or within itself");
  EXPECT_EQ(complaint(R"({"primitives": [], "camera": {"fov": 200}})"),
            "camera: has a field of view of 200 degrees");
  EXPECT_EQ(complaint(with(R"({"type": "quad", "transform": {"scale": [1, "x", 1]}})")),
            "primitives[0].transform.scale[1]: is no number");
}

}  // namespace tdpt::foreign::tungsten_test
