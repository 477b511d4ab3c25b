#include "tools/tdpt-import/gltf/gltf.h"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "libcommon/formats/environment.h"
#include "libcommon/formats/picture.h"
#include "libcommon/formats/portal.h"
#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/temp_folder.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign::writer_test {

using std::numbers::pi;

// A lamp in front of a camera that looks along -z of `to_world`, and a floor.
Described room(const Affine& to_world) {
  Described d;
  d.title = "room";
  d.meshes.push_back(square());
  Material grey;
  grey.name = "grey";
  grey.base.factor = Rgb(0.5f);
  d.materials.push_back(grey);
  Shape lamp;
  lamp.name = "lamp";
  lamp.to_world = to_world * Affine{{1, 0, 0}, {0, 2, 0}, {0, 0, 1}, {3, 1, -5}};
  lamp.emission = Emission{{{8, 4, 2}, {}, {}}, false};
  Shape floor;
  floor.to_world = to_world * Affine{{10, 0, 0}, {0, 0, -10}, {0, 10, 0}, {0, -4, 0}};
  d.shapes = {lamp, floor};
  Camera camera;
  camera.name = "camera";
  camera.to_world = to_world;
  camera.width = 200, camera.height = 100;
  d.cameras = {camera};
  return d;
}

struct Result {
  GltfOutput written;
  tdpt::Scene scene;
  nlohmann::json json;
  std::vector<std::string> losses;
};

Result write(const Described& d, const std::string& up = "auto", int longest = 0) {
  const testing::TempFolder folder;
  Source source(folder.write("scene.xml", ""));
  GltfOptions how;
  how.up = up;
  how.environment = "room.environment";
  how.format = "Mitsuba";
  how.longest_texture = longest;
  Result r{write_gltf(d, how, source), {}, {}, {}};
  for (const auto& loss : source.losses()) r.losses.push_back(loss.sentence);
  uint32_t length;
  std::memcpy(&length, r.written.glb.data() + 12, 4);
  r.json = nlohmann::json::parse(r.written.glb.substr(20, length));
  if (!r.written.environment.empty())
    folder.write("room.environment" + r.written.environment_suffix, r.written.environment);
  r.scene = read_gltf(folder.write("room.glb", r.written.glb));
  return r;
}

// Axes at right angles, right-handed, of no axis' own.
Affine turned() {
  return *affine_of({4, -2, 7}, {0.1, 0.5, -0.2, 0.8}, Vec3d(1));
}
Affine mirrored() {
  return turned() * Affine{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}};
}

// What a camera sees stays, whatever the frame of the source: the corners of the lamp lie where
// they lay in the camera's own frame, and it shines towards the camera, or
// away from it where it is turned.
TEST(ImportWriter, CameraSeesTheSame) {
  for (const Affine& at : {Affine{}, turned(), mirrored()})
    for (const char* up : {"auto", "x", "y", "z"}) {
      Described d = room(at);
      d.shapes[0].turned = up[0] == 'x';
      const Result r = write(d, up);
      const tdpt::Camera& c = r.scene.cameras.at(0);
      EXPECT_EQ(r.written.frame.mirrored, at.mirrors());
      EXPECT_NEAR(length(cross(c.right, c.up) + c.forward), 0, 1e-9);  // no mirror image
      Vec3d low(1e9), high(-1e9);
      size_t emitting = 0;
      for (uint32_t t = 0; t < r.scene.triangles.size(); ++t) {
        if (!(r.scene.material_of(t).emission.x > 0)) continue;
        ++emitting;
        Vec3d p[3];
        for (int k = 0; k < 3; ++k) {
          const Vec3d off = (Vec3d(r.scene.vertex(t, k)) - c.position) / r.scene.frame.scale;
          p[k] = {dot(off, c.right), dot(off, c.up), dot(off, c.forward)};
          low = min(low, p[k]), high = max(high, p[k]);
        }
        // In a frame of right, up and forward, which is left-handed, a front has +z towards us.
        EXPECT_EQ(cross(p[1] - p[0], p[2] - p[0]).z < 0, d.shapes[0].turned);
      }
      EXPECT_EQ(emitting, 2u);
      EXPECT_NEAR(length(low - Vec3d(2, -1, 5)), 0, 1e-5);
      EXPECT_NEAR(length(high - Vec3d(4, 3, 5)), 0, 1e-5);
      EXPECT_EQ(r.scene.material_of(0).emission.y * 2, r.scene.material_of(0).emission.x);
      EXPECT_EQ(r.scene.defaults.width, 200);
    }
}

TEST(ImportWriter, UpGoesByTheCamera) {
  const auto up_of = [](const Vec3d& y) {
    const Vec3d z = Onb<double>(y).x;
    return write(room({cross(y, z), y, z, {}})).written.frame;
  };
  EXPECT_EQ(up_of({0, 1, 0}).up, "y");
  EXPECT_EQ(up_of(normalize(Vec3d(0.1, 0.3, 0.9))).up, "z");
  EXPECT_EQ(up_of({-1, 0, 0}).up, "x");
  EXPECT_TRUE(up_of({-1, 0, 0}).downwards);
  const tdpt::Camera c =
      write(room(*affine_of({}, {0.7071067811865476, 0, 0, 0.7071067811865476}, Vec3d(1))))
          .scene.cameras[0];
  EXPECT_NEAR(c.up.y, 1, 1e-6);  // z was up
}

TEST(ImportWriter, ShearIsPutIntoTheMesh) {
  Described d = room({});
  d.shapes[0].to_world = {{1, 0, 0}, {0.5, 2, 0}, {0, 0, 1}, {0, 0, -5}};
  const Result r = write(d);
  double most = -1e9;
  for (uint32_t corner = 0; corner < 6; ++corner) {
    const Vec3f v = r.scene.vertex(corner / 3, static_cast<int>(corner % 3));
    most = std::max(most, r.scene.frame.to_metres(Vec3d(v)).x);
  }
  EXPECT_NEAR(most, 1.5, 1e-5);
  EXPECT_FALSE(r.json["nodes"][1].contains("matrix"));
  EXPECT_FALSE(r.json["nodes"][1].contains("scale"));
}

TEST(ImportWriter, MeshesAreSharedAndSaysWhereItIsFrom) {
  Described d = room({});
  d.shapes.push_back(d.shapes[1]);
  d.shapes.back().to_world.t = {1, 2, 3};
  const Result r = write(d);
  EXPECT_EQ(r.json["meshes"].size(), 2u);  // with and without light
  EXPECT_EQ(r.json["asset"]["extras"]["source"], "Mitsuba");
  EXPECT_EQ(r.scene.warnings, std::vector<std::string>{});
  EXPECT_EQ(r.losses, std::vector<std::string>{});
}

// The sky is seen in the same direction as in the source.
void expect_sky(const Described& d, const char* up, double tolerance) {
  const Result r = write(d, up);
  const std::string& bytes = r.written.environment;
  const tdpt::Sky sky(parse_environment(bytes, "sky"),
                      r.scene.defaults.rotation.value_or(0) * pi / 180);
  const double scale = r.scene.defaults.scale.value_or(1);
  const tdpt::Sky source_map({d.images[0].width, d.images[0].height, d.images[0].texels}, 0);
  for (const Vec3d& towards : {Vec3d(1, 0.3, 0.2), Vec3d(-0.3, -0.5, 0.8), Vec3d(0.1, 0.9, -0.4),
                               Vec3d(-0.9, 0.2, -0.3)}) {
    const Vec3d in_source = normalize(towards);
    const Rgb expected = source_map.radiance(d.sky->to_map.vector(in_source)) * d.sky->colour;
    const Rgb found =
        sky.radiance(r.written.frame.to_gltf.vector(in_source)) * static_cast<float>(scale);
    EXPECT_NEAR(found.x, expected.x, tolerance);
    EXPECT_NEAR(found.y, expected.y, tolerance);
    EXPECT_NEAR(found.z, expected.z, tolerance);
  }
}

Described with_sky(const Affine& camera, const Affine& to_map, bool as_file) {
  Described d = room(camera);
  d.images.push_back({"sky", {}, 64, 32, {}});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x) {
      const double phi = ((x + 0.5) / 64 - 0.5) * 2 * pi, theta = (y + 0.5) / 32 * pi,
                   s = std::sin(theta);
      d.images[0].texels.emplace_back(static_cast<float>(1.5 + s * std::sin(phi)),
                                      static_cast<float>(1.5 + std::cos(theta)),
                                      static_cast<float>(1.5 - s * std::cos(phi)));
    }
  if (as_file) {
    ExrFile file;
    file.picture = {64, 32, d.images[0].texels, {}};
    d.images[0].bytes = exr_bytes(file);
  }
  foreign::Sky sky;
  sky.colour = Rgb(0.5f);
  sky.image = 0;
  sky.to_map = to_map;
  d.sky = sky;
  return d;
}

TEST(ImportWriter, SkyKeepsItsDirections) {
  const Affine quarter{{0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {}};
  const Affine mirror{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}};
  for (const bool as_file : {true, false}) {
    expect_sky(with_sky({}, {}, as_file), "y", 0.02);
    expect_sky(with_sky({}, quarter, as_file), "y", 0.02);
    expect_sky(with_sky({}, mirror, as_file), "y", 0.02);
    expect_sky(with_sky(mirrored(), quarter, as_file), "y", 0.02);
    Affine r = turned();
    r.t = {};
    expect_sky(with_sky({}, r, as_file), "z", 0.03);
  }
  // A copy where turning is enough, a new map where it is not.
  const Described d = with_sky({}, quarter, true);
  EXPECT_EQ(write(d, "y").written.environment, d.images[0].bytes);
  EXPECT_NE(write(with_sky({}, mirror, true), "y").written.environment, d.images[0].bytes);
}

// What lights a scene: power, and its vector, of the sky as the renderer reads it.
std::array<double, 4> power_of(const tdpt::Sky& sky) {
  std::array<double, 4> sum{};
  const auto& map = sky.map();
  for (int row = 0; row <= map.height; ++row)
    for (int column = 0; column < map.width; ++column)
      for (const double down : {0.21132486540518713, 0.7886751345948129})
        for (const double across : {0.21132486540518713, 0.7886751345948129}) {
          const Vec3d d = sky.towards(tdpt::Sky::Cell{column, row, across, down});
          const double power = sky.radiance(d).x * sky.solid_angle(row) / 4;
          sum[0] += power, sum[1] += power * d.x, sum[2] += power * d.y, sum[3] += power * d.z;
        }
  return sum;
}

// A sun of one texel, wherever it stands and however the map is turned: its power and direction;
// and one colour stays one colour.
struct TurnedSun {
  double power, off, uneven;
};
TurnedSun turned_sun(const Affine& to_map, foreign::Sky::Layout layout, int width, size_t at,
                     double solid_angle) {
  const bool square = layout == foreign::Sky::Layout::octahedral;
  Described d = with_sky({}, to_map, false);
  d.sky->layout = layout;
  d.sky->colour = Rgb(1);
  Image& image = d.images[0];
  image.width = width, image.height = square ? width : width / 2;
  const auto map_of = [&](const Described& scene) {
    return tdpt::Sky(parse_environment(write(scene, "y").written.environment, "sky"), 0);
  };
  image.texels.assign(static_cast<size_t>(image.width * image.height), Rgb(1));
  const tdpt::Sky even = map_of(d);
  image.texels.assign(image.texels.size(), Rgb(0));
  image.texels[at] = Rgb(100);
  const auto sun = power_of(map_of(d));
  TurnedSun out{sun[0] / (100 * solid_angle), 1 - std::hypot(sun[1], sun[2], sun[3]) / sun[0], 0};
  for (const Rgb& c : even.map().texels) out.uneven = std::max(out.uneven, std::abs(c.y - 1.0));
  return out;
}

TEST(ImportWriter, TurnedSkiesKeepTheirPower) {
  using enum foreign::Sky::Layout;
  const Affine mirror{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}};
  Affine tilted = turned(), upright{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {}};
  tilted.t = {};
  for (const Affine& to_map : {tilted, upright, tilted * mirror, mirror})
    for (const int width : {64, 96})
      for (const int row : {0, 1, width / 5, width / 4, width / 2 - 1}) {
        const double angle = 2 * pi / width;
        const double solid_angle = angle * (std::cos(angle * row) - std::cos(angle * (row + 1)));
        const auto at = static_cast<size_t>(row * width + 7 * row % width);
        const TurnedSun sun = turned_sun(to_map, latlong, width, at, solid_angle);
        EXPECT_NEAR(sun.power, 1, 1e-5) << width << " " << row;
        EXPECT_LT(sun.off, angle * angle) << width << " " << row;
        EXPECT_LT(sun.uneven, 1.5e-3) << width << " " << row;
      }
  for (const size_t at : {0u, 31u, 32u * 15 + 15, 32u * 9 + 22}) {
    const TurnedSun sun = turned_sun(tilted, octahedral, 32, at, 4 * pi / 1024);
    EXPECT_NEAR(sun.power, 1, 1e-5) << at;
    EXPECT_LT(sun.uneven, 1.5e-3) << at;
  }
}

// The twin: the same sun where a sky is looked up once for each texel, as at first.
TEST(ImportWriter, TwinOneSampleForATexelLosesPower) {
  Affine to_map = turned();
  to_map.t = {};
  double worst = 0;
  for (const int row : {3, 12, 16, 25}) {
    tdpt::Sky::Map given{64, 32, std::vector<Rgb>(64 * 32, Rgb(0))}, out{64, 32, {}};
    given.texels[static_cast<size_t>(row * 64 + row)] = Rgb(100);
    const tdpt::Sky from(given, 0), grid(given, 0);
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 64; ++x)
        out.texels.push_back(from.radiance(to_map.vector(grid.towards(x + 0.5, y + 0.5))));
    const double ratio = power_of(tdpt::Sky(out, 0))[0] / power_of(from)[0];
    worst = std::max(worst, std::abs(ratio - 1));
  }
  EXPECT_GT(worst, 0.05);
}

TEST(ImportWriter, SkiesThatAreNoneAreRefusedOrDark) {
  Described d = with_sky({}, turned(), false);
  const auto complaint = [&]() -> std::string {
    try {
      const Result r = write(d);
      return r.losses.empty() ? "" : r.losses.back();
    } catch (const InputError& e) {
      return e.what();
    }
  };
  const auto expect = [&](const char* words) {
    EXPECT_NE(complaint().find(words), std::string::npos) << complaint();
  };
  d.images[0].texels[65].y = std::numeric_limits<float>::infinity();
  expect("sky:pixel 1 1: is no radiance");
  d.images[0].texels[65].y = -1;
  expect("negative radiances");
  d.images[0].texels.assign(64 * 32, Rgb(0));
  EXPECT_EQ(write(d).scene.defaults.environment, "");
  d.images[0] = {"sky", {}, 1, 1, {Rgb(2, 4, 6)}};  // one texel is one colour
  const auto colour = [&] { return write(d).json["scenes"][0]["extras"]["tdpt_environment"]; };
  EXPECT_EQ(colour(), nlohmann::json({1.0, 2.0, 3.0}));
  d.images[0] = {"sky", {}, 2, 1, {Rgb(1), Rgb(2)}};
  d.sky->layout = Sky::Layout::octahedral;
  expect("is 2 x 1 texels, expected a square");
  d.images[0] = {"sky.hdr", "", 0, 0, {}};
  expect("sky.hdr: is empty");
  d.sky.reset();
  d.materials[0].base.texture = Texture{};
  expect("sky.hdr: is empty");
  // A grey TGA: of 8 bits, decoded if the source does.
  d = room({});
  const std::string grey("\0\0\x03\0\0\0\0\0\0\0\0\0\x01\0\x01\0\x08\x20\x80", 19);
  d.images.push_back({"sky.tga", grey, 0, 0, {}});
  d.sky = Sky{Rgb(1), 0, true, Sky::Layout::latlong, {}};
  EXPECT_NEAR(colour()[0].get<double>(), 0.2159, 1e-3);
  d.sky->srgb = false;
  EXPECT_NEAR(colour()[0].get<double>(), 128 / 255.0, 1e-6);
}

// Portals lie where they lay, and their fronts face the camera; where the source says otherwise,
// both ways are open. The camera of room() is at the origin of `at`.
TEST(ImportWriter, PortalsLieBesideTheScene) {
  EXPECT_EQ(write(room({})).written.portals, "");
  for (const Affine& at : {Affine{}, turned(), mirrored()})
    for (const bool away : {false, true}) {
      Described d = room(at);
      Shape portal;
      portal.to_world = at * Affine{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, -6}};
      portal.turned = away;
      d.portals = {portal};
      const Result r = write(d);
      const testing::TempFolder folder;
      const PortalFile file = read_portals(folder.write("room.portal.glb", r.written.portals));
      EXPECT_EQ(file.scene_hash, "");
      ASSERT_EQ(file.portals.size(), 1u);
      const tdpt::Portal& p = file.portals[0];
      EXPECT_EQ(p.name, "portal.0");
      EXPECT_NEAR(area_of(p), 8, 1e-5);
      EXPECT_EQ(p.both_ways, away);
      const Vec3d eye = r.written.frame.to_gltf.point(at.t);
      for (const auto& [a, b, c] : p.triangles)
        EXPECT_GT(dot(cross(p.vertices[b] - p.vertices[a], p.vertices[c] - p.vertices[a]),
                      eye - p.vertices[a]),
                  0);
    }
}

TEST(ImportWriter, PortalsWithoutAnAreaOrBeyondAllNumbersAreNone) {
  Described d = room({});
  d.portals.resize(1);
  d.portals[0].to_world.x = {};
  const Result r = write(d);
  EXPECT_EQ(r.written.portals, "");
  EXPECT_EQ(r.losses.size(), 1u);
  d.portals[0].to_world = {};
  d.portals[0].to_world.t.x = 1e39;
  EXPECT_THROW(write(d), InputError);
}

// A picture of two texels on the grey surface, or on the lamp, and what of it is written.
struct Textured {
  const char* what;
  Image image;
  std::function<void(Described&)> use;
  size_t channel;  // the place in r g b a of the first texel
  int value;
  const char* lost = "";
};

TEST(ImportWriter, TexelsAreWhatTheirUseNeeds) {
  const auto picture = [](const Rgb& first, const Rgb& second) {
    return Image{"a", {}, 2, 1, {first, second}};
  };
  ExrFile file;
  file.picture = {2, 1, {Rgb(0.5f), Rgb(0.5f)}, {0.2f, 0.4f}};
  const Image leaf{"leaf.exr", exr_bytes(file), 0, 0, {}};
  const Image mask = picture(Rgb(1, 0, 0), Rgb(0)), map = picture({0.5f, 0.8f, 1}, {0.5f, 0.2f, 1}),
              bright = picture(Rgb(0.5f), Rgb(2)), dark = picture(Rgb(0.2f), Rgb(0.1f)),
              glow = picture(Rgb(std::numeric_limits<float>::infinity()), Rgb(3));
  const auto opacity = [](Described& d) { d.materials[0].opacity.texture = Texture{}; };
  const auto normal = [](Described& d) { d.materials[0].normal = Texture{}; };
  const auto base = [](Described& d) { d.materials[0].base.texture = Texture{}; };
  const auto lamp = [](Described& d) { d.shapes[0].emission->radiance.texture = Texture{}; };
  const std::vector<Textured> cases{
      {"opacity as alpha", picture(Rgb(0), Rgb(1)), opacity, 3, 0},
      {"the mean as a number", mask, opacity, 3, 85},
      {"luminance as a number", mask,
       [&](Described& d) { opacity(d), d.materials[0].opacity.texture->luminance = true; }, 3, 54},
      {"alpha as a number", leaf,
       [&](Described& d) { opacity(d), d.materials[0].opacity.texture->alpha = true; }, 3, 51},
      {"a normal map", map, normal, 1, 204},
      {"a normal map with +Y down", map,
       [&](Described& d) { normal(d), d.materials[0].normal->green_down = true; }, 1, 51},
      {"light above 1", bright, lamp, 0, 137},
      {"reflectance above 1", bright, base, 0, 188, "reflectances above 1"},
      // JSON has no infinity.
      {"light without a value", glow, lamp, 0, 0, "not finite"},
      // Of 0.2, which its scene multiplies by 3: sRGB of 0.6.
      {"a factor above 1", dark,
       [](Described& d) {
         d.materials[0].base = {Rgb(3), Texture{}, {}};
       },
       0, 203},
      {"opacity with a factor above 1", dark,
       [](Described& d) {
         d.materials[0].opacity = {3, Texture{}, {}};
       },
       3, 153},
      // The lists of the file begin in another order there.
      {"a picture without a camera", dark, [&](Described& d) { base(d), d.cameras.clear(); }, 0,
       124},
  };
  for (const Textured& c : cases) {
    SCOPED_TRACE(c.what);
    Described d = room({});
    d.images = {c.image};
    c.use(d);
    const Result r = write(d);
    ASSERT_EQ(r.scene.images.size(), 1u);
    EXPECT_EQ(r.scene.images[0].texels.at(c.channel), c.value);
    ASSERT_EQ(r.losses.size(), *c.lost ? 1u : 0u);
    if (*c.lost) EXPECT_NE(r.losses[0].find(c.lost), std::string::npos) << r.losses[0];
  }
}

TEST(ImportWriter, TexturesKeepTheirValuesAndTheirPlaces) {
  Described d = room({});
  d.images.push_back({"wood", {}, 4, 4, std::vector<Rgb>(16, Rgb(0.2f, 0.5f, 0.8f))});
  d.images[0].texels[15] = Rgb(0.9f);
  d.materials[0].base.texture = Texture{};
  // A rotation after a scale, as KHR_texture_transform has it.
  const double c = std::cos(0.3), s = std::sin(0.3);
  const std::array<double, 6> map{2 * c, 5 * s, 0.25, -2 * s, 5 * c, 0.5};
  d.materials[0].base.texture->map = map;
  const Result r = write(d);
  EXPECT_TRUE(r.losses.empty());
  ASSERT_EQ(r.scene.images.size(), 1u);
  EXPECT_EQ(r.scene.images[0].texels[0], 124);  // sRGB of 0.2
  EXPECT_EQ(r.scene.images[0].texels[1], 188);  // of 0.5
  const size_t wooden = r.scene.materials[0].maps[0].image >= 0 ? 0 : 1;
  const auto& found = r.scene.materials[wooden].maps[0].transform;
  for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(found[i], map[i], 1e-6) << i;
  EXPECT_EQ(write(d, "y", 2).scene.images[0].width, 2);
  d.materials[0].base.texture->map = {2, 1, 0, 0, 2, 0};
  EXPECT_EQ(write(d).losses.size(), 1u);  // sheared
}

TEST(ImportWriter, LampsShineWhereTheyDid) {
  Described d = room(mirrored());
  Lamp spot;
  spot.kind = Lamp::Kind::spot;
  spot.at = {1, 2, 3}, spot.towards = {0.3, -1, 0.2};
  spot.intensity = {3, 6, 9}, spot.inner = 0.2, spot.outer = 0.4;
  Lamp sun;
  sun.kind = Lamp::Kind::sun;
  sun.towards = {0, 0, 2}, sun.intensity = {1, 1, 1};
  d.lamps = {spot, sun};
  const Result r = write(d);
  ASSERT_EQ(r.scene.lights.size(), 2u);
  const Vec3d at = r.scene.frame.to_metres(r.scene.lights[0].position);
  EXPECT_NEAR(length(at - r.written.frame.to_gltf.point(spot.at)), 0, 1e-6);
  EXPECT_NEAR(
      length(r.scene.lights[0].direction - normalize(r.written.frame.to_gltf.vector(spot.towards))),
      0, 1e-6);
  EXPECT_NEAR(r.scene.lights[0].cos_inner, std::cos(0.2), 1e-6);
  EXPECT_NEAR(length(r.scene.lights[1].direction - r.written.frame.to_gltf.vector({0, 0, 1})), 0,
              1e-6);
  EXPECT_NEAR(r.scene.lights[1].intensity.x, 1, 1e-6);
}

TEST(ImportWriter, WhatGltfLacksIsNamed) {
  Described d = room({});
  d.cameras[0].lens_radius = 0.1, d.cameras[0].focus_distance = 3;
  d.materials[0].bump = Texture{};
  d.materials[0].tinted = true;
  d.images.push_back({"bump", {}, 1, 1, {Rgb(0)}});
  d.materials[0].base.factor = Rgb(1.5f);
  const std::vector<std::string> losses = write(d).losses;
  ASSERT_EQ(losses.size(), 4u);
  // 18 mm / (2 tan 0.25) of focal length, over 0.2 m.
  EXPECT_NE(losses[0].find("--f-stop 0.1762 --focus 3"), std::string::npos) << losses[0];
  EXPECT_EQ(losses[1], "reflectances above 1 are taken as 1");
  EXPECT_NE(losses[2].find("at grazing ones"), std::string::npos);
  EXPECT_EQ(losses[3], "bump maps are left out");
}

}  // namespace tdpt::foreign::writer_test
