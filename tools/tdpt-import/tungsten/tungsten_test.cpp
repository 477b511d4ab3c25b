#include "tools/tdpt-import/described.h"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
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

// Angles are of single precision.
void expect_near(const Vec3d& a, const Vec3d& b) {
  EXPECT_NEAR(a.x, b.x, 1e-6);
  EXPECT_NEAR(a.y, b.y, 1e-6);
  EXPECT_NEAR(a.z, b.z, 1e-6);
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
  // A material prevails over eta and k, and eta stands alone beside copper's k.
  EXPECT_EQ((*material(R"({"type": "conductor", "eta": 2})").eta_k)[0].x, 2);
  EXPECT_GT((*material(R"({"type": "conductor", "eta": 2})").eta_k)[1].x, 3);
  EXPECT_EQ((*material(R"({"type": "conductor", "eta": 2, "k": 7})").eta_k)[1].x, 7);
  EXPECT_NE((*material(R"({"type": "conductor", "material": "Al", "eta": 2, "k": 7})").eta_k)[1].x,
            7);
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

// Tungsten's own (u, v) at a point of a shape with axes X, Y, Z of lengths s at the origin, by
// intersectionInfo() of its sources; std::nullopt where they have no u.
using Uv = std::array<double, 2>;
std::optional<Uv> tungsten_uv(const std::string& type, const Vec3d& p, const Vec3d& n,
                              const std::array<Vec3d, 3>& axes, const Vec3d& s) {
  const auto turned = [](double y, double x) { return std::atan2(y, x) / (2 * pi) + 0.5; };
  const double x = dot(p, axes[0]), y = dot(p, axes[1]), z = dot(p, axes[2]);
  const double wide = std::max(s.x, s.z);
  if (type == "quad") return Uv{x / s.x + 0.5, z / s.z + 0.5};
  if (type == "cube") {
    const double at[] = {x / s.x + 0.5, y / s.y + 0.5, z / s.z + 0.5};
    size_t dim = 0;
    for (size_t i = 1; i < 3; ++i)
      if (std::abs(dot(n, axes[i])) > std::abs(dot(n, axes[dim]))) dim = i;
    return Uv{at[(dim + 1) % 3], at[(dim + 2) % 3]};
  }
  if (type == "sphere") {
    if (std::hypot(x, y) < 1e-5) return {};
    return Uv{turned(y, x), std::acos(std::clamp(z / length(p), -1.0, 1.0)) / pi};
  }
  if (type == "disk") {  // the frame of Duff et al. about the normal
    const Vec3d m = axes[1];
    const double sign = m.z < 0 ? -1 : 1, a = -1 / (sign + m.z), b = m.x * m.y * a;
    const Vec3d tangent{1 + sign * m.x * m.x * a, sign * b, -sign * m.x};
    const Vec3d bitangent{b, sign + m.y * m.y * a, -m.y};
    if (length(p) < 1e-6) return {};
    return Uv{turned(dot(p, tangent), dot(p, bitangent)), length(p) / wide};
  }
  if (std::abs(dot(n, axes[1])) > 0.5) return Uv{x / wide + 0.5, z / wide + 0.5};  // a cap
  return Uv{turned(z, x), y / s.y + 0.5};
}

// Images lie on shapes as in Tungsten: all of its vertices, turned and of uneven size.
TEST(Tungsten, ImagesLieOnShapesAsInItsSources) {
  const std::array<Vec3d, 3> axes{Vec3d{2, 2, 1} / 3.0, Vec3d{-2, 1, 2} / 3.0,
                                  Vec3d{1, -2, 2} / 3.0};
  const Vec3d s{1.5, 2.5, 2};
  const Vec3d x = axes[0] * s.x, y = axes[1] * s.y, z = axes[2] * s.z;
  const std::string matrix = fmt::format("[{},{},{},0, {},{},{},0, {},{},{},0, 0,0,0,1]", x.x, y.x,
                                         z.x, x.y, y.y, z.y, x.z, y.z, z.z);
  for (const std::string type : {"quad", "sphere", "disk", "cube", "cylinder"}) {
    const Described d =
        read(with(R"({"type": ")" + type + R"(", "transform": )" + matrix + "}")).scene;
    const Shape& shape = d.shapes.at(0);
    const Mesh& mesh = d.meshes.at(shape.mesh);
    size_t compared = 0;
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      const Vec3f &p = mesh.positions[i], &n = mesh.normals[i];
      const auto uv = tungsten_uv(type, shape.to_world.point({p.x, p.y, p.z}),
                                  shape.to_world.vector({n.x, n.y, n.z}), axes, s);
      if (!uv) continue;
      const double turns = mesh.uv[i][0] - (*uv)[0], rows = mesh.uv[i][1] - (1 - (*uv)[1]);
      ASSERT_NEAR(turns, std::round(turns), 3e-3) << type << " " << i;  // corners lie outside
      ASSERT_NEAR(rows, 0, 3e-3) << type << " " << i;
      ++compared;
    }
    EXPECT_GE(compared, 4u) << type;
  }
}

TEST(Tungsten, CylindersAreHalfAsWideAsTheirScale) {
  const auto widest = [](const char* more) {
    const Described d = read(with(R"({"type": "cylinder", "transform": {"scale": [1, 4, 3]})" +
                                  std::string(more) + "}"))
                            .scene;
    Vec3d most(0);
    for (const Vec3f& p : d.meshes.at(0).positions) {
      const Vec3d at = d.shapes.at(0).to_world.point({p.x, p.y, p.z});
      most = {std::max(most.x, at.x), std::max(most.y, at.y), std::max(most.z, at.z)};
    }
    return most;
  };
  for (const char* more : {"", R"(, "capped": false)"}) {
    EXPECT_NEAR(widest(more).x, 1.5, 0.01) << more;  // of the larger scale
    EXPECT_NEAR(widest(more).y, 2, 1e-6) << more;
    EXPECT_NEAR(widest(more).z, 1.5, 0.01) << more;
  }
  // The area of its caps counts for its power, whether it has them or not.
  for (const char* capped : {"true", "false"}) {
    const Read r =
        read(with(R"({"type": "cylinder", "power": 12, "capped": )" + std::string(capped) + "}"));
    const double area = 2 * pi * 0.25 + pi;
    EXPECT_NEAR(r.scene.shapes.at(0).emission->radiance.factor.x, 12 / (pi * area), 1e-4);
    EXPECT_TRUE(r.losses.empty());
  }
  const Described capped = read(with(R"({"type": "cylinder"})")).scene;
  double surface = 0;
  for (const auto& [a, b, c] : capped.meshes.at(0).triangles) {
    const auto at = [&](uint32_t i) {
      const Vec3f& p = capped.meshes.at(0).positions[i];
      return Vec3d{p.x, p.y, p.z};
    };
    const Vec3d front = cross(at(b) - at(a), at(c) - at(a));
    surface += length(front) / 2;
    EXPECT_GT(dot(front, (at(a) + at(b) + at(c)) / 3.0 - Vec3d{0, 0, 0.5}), 0);  // outside
  }
  EXPECT_NEAR(surface, pi + pi / 2, 1e-4);  // of radius 1/2 and height 1
}

TEST(Tungsten, DisksAreRoundAndShineWithinTheirCone) {
  const std::string disk = R"({"type": "disk", "emission": 5, "transform":
    {"position": [0, 3, 0], "scale": [2, 1, 1], "rotation": [180, 0, 0]})";
  const Read whole = read(with(disk + "}"));
  EXPECT_EQ(whole.scene.shapes.at(0).emission->radiance.factor.x, 5);
  EXPECT_NEAR(length(whole.scene.shapes[0].to_world.x), 2, 1e-6);
  EXPECT_NEAR(length(whole.scene.shapes[0].to_world.y), 2, 1e-6);
  expect_near(front(whole.scene.shapes[0]), {0, -1, 0});
  EXPECT_TRUE(whole.losses.empty());
  const Read cone = read(with(disk + R"(, "cone_angle": 20})"));
  EXPECT_FALSE(cone.scene.shapes.at(0).emission);
  const Lamp& spot = cone.scene.lamps.at(0);
  expect_near(normalize(spot.towards), {0, -1, 0});
  EXPECT_LT(spot.at.y, 3);  // in front of the disk
  EXPECT_NEAR(spot.outer, 20 * pi / 180, 1e-9);
  // pi sin^2 is the cosine over the cone, 2 pi (1 - cos) its solid angle.
  const double power = 5 * (pi * 4) * pi * std::pow(std::sin(20 * pi / 180), 2);
  EXPECT_NEAR(spot.intensity.x * 2 * pi * (1 - std::cos(20 * pi / 180)), power, 1e-3);
  ASSERT_EQ(cone.losses.size(), 1u);
  EXPECT_NE(cone.losses[0].find("cone_angle"), std::string::npos);
  EXPECT_TRUE(read(with(R"({"type": "disk", "cone_angle": 20})")).losses.empty());  // no lamp
}

// Tungsten never decodes numbers from sRGB.
TEST(Tungsten, NumbersOfPicturesAreTakenAsTheyAre) {
  for (const char* r : {R"("wood.png")", R"({"type": "bitmap", "file": "wood.png"})",
                        R"({"type": "bitmap", "file": "wood.png", "gamma_correct": false})"}) {
    const std::string rough =
        R"({"type": "rough_conductor", "bump": )" + std::string(r) + R"(, "roughness": )" + r + "}";
    const Material m = material(rough);
    EXPECT_FALSE(m.roughness.texture->srgb) << r;
    EXPECT_FALSE(m.bump->srgb) << r;
    EXPECT_FALSE(material(R"({"type": "transparency", "base": {"type": "lambert"}, "alpha": )" +
                          std::string(r) + "}")
                     .opacity.texture->srgb)
        << r;
  }
  EXPECT_TRUE(material(R"({"type": "lambert", "albedo": "wood.png"})").base.texture->srgb);
}

TEST(Tungsten, SkiesAreDecodedUnlessTheySayOtherwise) {
  const auto sky = [](const char* more) {
    return read(with(R"({"type": "infinite_sphere", "emission": {"type": "bitmap", "file":
      "wood.png")" + std::string(more) +
                     "}}"));
  };
  EXPECT_TRUE(sky("").scene.sky->srgb);
  const Read plain = sky(R"(, "gamma_correct": false)");
  EXPECT_FALSE(plain.scene.sky->srgb);
  EXPECT_TRUE(plain.losses.empty());
}

TEST(Tungsten, LossesOfSurfacesAreNamed) {
  const auto lost = [](const std::string& bsdf) {
    std::string all;
    for (const auto& l : read(with(R"({"type": "quad", "bsdf": )" + bsdf + "}")).losses) all += l;
    return all;
  };
  for (const char* type : {"smooth_coat", "rough_coat", "plastic", "rough_plastic"}) {
    const std::string coat = R"({"type": ")" + std::string(type) + R"(", "substrate":
      {"type": "lambert"}, "thickness": 1, "sigma_a": )";
    EXPECT_NE(lost(coat + "[0.1, 1, 2]}").find("sigma_a"), std::string::npos) << type;
    EXPECT_EQ(lost(coat + "0}").find("sigma_a"), std::string::npos) << type;
  }
  const std::string metal = R"({"type": "rough_conductor", "roughness": )";
  EXPECT_EQ(lost(metal + "0.2}"), "");
  EXPECT_NE(lost(metal + "1}").find("metals of roughness 1 reflect"), std::string::npos);
  const std::string mixed = R"({"type": "mixed", "bsdf0": {"type": "lambert"}, "bsdf1":
    {"type": "mirror", "foo": 1}, "albedo": )";
  EXPECT_NE(lost(mixed + "0.5}").find("the albedo of mixed"), std::string::npos);
  EXPECT_EQ(lost(mixed + "1}").find("albedo"), std::string::npos);
  EXPECT_EQ(lost(mixed + "1}").find("foo"), std::string::npos);  // of the one that is not used
}

TEST(Tungsten, LimitsOfTheIntegratorAreNamed) {
  const auto lost = [](const char* settings) {
    const Read r = read(R"({"primitives": [], "integrator": {"type": "path_tracer")" +
                        std::string(settings) + "}}");
    return r.losses.empty() ? "" : r.losses[0];
  };
  EXPECT_NE(lost(R"(, "max_bounces": 8)").find("--max-depth 8 "), std::string::npos);
  EXPECT_EQ(lost(R"(, "max_bounces": 64)"), "");
  EXPECT_NE(lost(R"(, "min_bounces": 1)"), "");
  EXPECT_NE(lost(R"(, "enable_two_sided_shading": false)"), "");
  EXPECT_EQ(lost(""), "");
}

// A key that nobody knows is named once, in whatever object it stands.
TEST(Tungsten, EveryUnknownKeyIsNamed) {
  const std::string scene = R"({"bsdfs": [
      {"name": "wall", "type": "lambert", "albedo": {"type": "checker"}},
      {"name": "pane", "type": "transparency", "alpha": 0.5, "base": {"type": "dielectric"}},
      {"name": "metal", "type": "rough_conductor", "roughness": {"type": "constant", "value": 0.1}},
      {"name": "paint", "type": "rough_plastic", "albedo":
        {"type": "bitmap", "file": "wood.png", "scale": 0.5}},
      {"name": "sheet", "type": "thinsheet"}, {"name": "none", "type": "null"},
      {"name": "mirror", "type": "mirror"}],
    "primitives": [
      {"type": "quad", "bsdf": "wall", "transform": {"scale": 2}, "emission": {"type": "constant"}},
      {"type": "sphere", "bsdf": "pane"}, {"type": "disk", "bsdf": "metal", "cone_angle": 90},
      {"type": "cylinder", "bsdf": "sheet"}, {"type": "cube", "bsdf": "none"},
      {"type": "cube", "bsdf": "mirror"},
      {"type": "mesh", "file": "room.obj", "bsdf": ["paint"]},
      {"type": "point", "power": 3}, {"type": "infinite_sphere", "emission": 1}],
    "camera": {"type": "thinlens", "transform": {"look_at": [0, 0, 1]}},
    "integrator": {"type": "path_tracer"}, "renderer": {"spp": 64, "scene_bvh": true}})";
  EXPECT_TRUE(read(scene).losses.empty());
  size_t objects = 0;
  const size_t end = scene.find("\"integrator\"");  // what cannot change the picture follows
  for (size_t at = 0; (at = scene.find('{', at)) < end; ++at, ++objects) {
    const Read r =
        read(scene.substr(0, at + 1) + R"("unheard": {"of": {}}, )" + scene.substr(at + 1));
    ASSERT_EQ(r.losses.size(), 1u) << scene.substr(at, 60);
    EXPECT_NE(r.losses[0].find("\"unheard\""), std::string::npos) << r.losses[0];
  }
  EXPECT_EQ(objects, 25u);
  // Nobody needs the keys of what nobody uses.
  EXPECT_TRUE(read(R"({"bsdfs": [{"name": "a", "type": "lambert", "unheard": 1}],
    "media": [{"unheard": 1}], "primitives": []})")
                  .losses.empty());
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
  ASSERT_EQ(r.losses.size(), 4u) << r.losses.back();
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
            "primitives[0].emission: \"a b\" cannot be opened: No such file or directory "
            "(--allow-missing goes on without it)");
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
