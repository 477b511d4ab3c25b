// Normals, tangents, texture coordinates and vertex colours in every encoding.
#include <gtest/gtest.h>
#include <cmath>
#include <cstring>
#include <limits>

#include "libcommon/base/error.h"
#include "libcommon/scene/scene.h"
#include "libcommon/scene/texture.h"
#include "libcommon/testing/files/glb_builder.h"
#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/scenes/needs.h"

namespace tdpt::testing::attributes_test {

using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

const std::vector<float> kPositions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
const std::string kTwo = png_of(2, 1, std::string("\xff\x80\x33\xff\0\0\0\x80", 8));

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A triangle in the plane z = 0 with a material that uses `map` ("baseColorTexture", ...).
struct Maker {
  GlbBuilder b;
  Json attributes, node = {{"mesh", 0}}, material;

  explicit Maker(const std::string& map = "") {
    attributes["POSITION"] = b.floats(kPositions, 3);
    material = {
        {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"metallicFactor", 0}}},
        {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}};
    if (map.empty()) return;
    (map == "normalTexture" ? material
                            : material["pbrMetallicRoughness"])[map] = {{"index", b.texture(kTwo)}};
  }
  template <class T>
  void integers(const std::string& name, const std::vector<T>& values, int components,
                bool normalized, int stride = 0) {
    const int type = (sizeof(T) == 1 ? 5120 : 5122) + std::is_unsigned_v<T>;
    std::string bytes;
    for (size_t i = 0; i < 3; ++i) {
      const auto n = static_cast<size_t>(components);
      std::string element =
          bytes_of(std::vector<T>(values.begin() + static_cast<long>(i * n),
                                  values.begin() + static_cast<long>((i + 1) * n)));
      element.resize(static_cast<size_t>(stride));
      bytes += element;
    }
    const int a = b.accessor(b.view(bytes, stride), type, "VEC" + std::to_string(components), 3);
    if (normalized) b.json["accessors"][static_cast<size_t>(a)]["normalized"] = true;
    attributes[name] = a;
  }
  void floats(const std::string& name, const std::vector<float>& values, int components) {
    attributes[name] = b.floats(values, components);
  }
  Scene load() {
    b.material(material);
    b.mesh({{"attributes", attributes}, {"material", 0}});
    b.node(node);
    const TempFolder folder;
    return read_gltf(folder.write("scene.glb", b.glb()));
  }
  std::string refusal() {
    try {
      load();
    } catch (const InputError& e) {
      const std::string what = e.what();
      return what.substr(what.find("scene.glb:") + 10);
    }
    return "";
  }
};

void expect_near(const Vec3f& a, const Vec3d& b) {
  EXPECT_LT(length(Vec3d(a) - b), 1e-6) << a.x << " " << a.y << " " << a.z;
}

const std::vector<float> kBent = {0.6f, 0, 0.8f, 0, 0.6f, 0.8f, 0, 0, 1};

TEST(Normals, AreKeptWhereSomeTriangleIsSmooth) {
  Maker m;
  m.floats("NORMAL", kBent, 3);
  const Scene s = m.load();
  ASSERT_EQ(s.normals.size(), 3u);
  expect_near(s.normals[0], {0.6, 0, 0.8});
  EXPECT_EQ(s.smooth, std::vector<uint8_t>{1});
  EXPECT_EQ(needs_of(s), Words{"shading normals"});
  EXPECT_TRUE(s.materials[0].plain);
  expect_near(Vec3f(shading_normal_at(s, {0, 0.5, 0.5}, {0, 0, 1})), normalize(Vec3d(0, 0.3, 0.9)));
}

TEST(Normals, FlatOnesCostNothing) {
  for (const std::vector<float>& n :
       {std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1},
        std::vector<float>{0, 0, -1, 0, 0, -1, 0, 0, -1},  // on the back: flipped
        std::vector<float>{9e-4f, 0, 1, 0, 9e-4f, 1, 0, 0, 5}}) {
    Maker m;
    m.floats("NORMAL", n, 3);
    const Scene s = m.load();
    EXPECT_TRUE(s.normals.empty() && s.smooth.empty());
    EXPECT_EQ(needs_of(s), Words{});
  }
}

TEST(Normals, OnTheBackAreTurnedRound) {
  Maker m;
  m.floats("NORMAL", {0.6f, 0, -0.8f, 0, 0.6f, -0.8f, 0, 0, -1}, 3);
  const Scene s = m.load();
  EXPECT_EQ(s.smooth, std::vector<uint8_t>{2});
  expect_near(Vec3f(shading_normal_at(s, {0, 0, 0}, {0, 0, 1})), {-0.6, 0, 0.8});
}

TEST(Normals, ZeroOrNotFiniteLeaveTheTriangleFlat) {
  for (float bad :
       {0.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Maker m;
    m.floats("NORMAL", {0.6f, 0, 0.8f, bad, bad, bad, 0, 0, 1}, 3);
    // JSON has no NaN for the limits.
    m.b.json["accessors"][1].erase("min");
    m.b.json["accessors"][1].erase("max");
    EXPECT_TRUE(m.load().smooth.empty());
  }
}

TEST(Normals, GoAlongByTheInverseTranspose) {
  const auto first = [](const Json& scale) {
    Maker m;
    m.floats("NORMAL", kBent, 3);
    m.node["scale"] = scale;
    const Scene s = m.load();
    EXPECT_EQ(s.smooth.size(), 1u);
    return s.normals.empty() ? Vec3f{} : s.normals[0];
  };
  expect_near(first({2, 1, 1}), normalize(Vec3d(0.3, 0, 0.8)));
  expect_near(first({1, 1, 4}), normalize(Vec3d(0.6, 0, 0.2)));
  expect_near(first({-1, 1, 1}), {-0.6, 0, 0.8});  // the front stays the front
  expect_near(first({1, 1, -1}), {0.6, 0, -0.8});
  expect_near(first({1e-12, 1e-12, 1e-12}), {0.6, 0, 0.8});
  expect_near(first({1e12, 1e12, 2e12}), normalize(Vec3d(0.6, 0, 0.4)));
  Maker flat;  // a flat map has no inverse
  flat.floats("NORMAL", kBent, 3);
  flat.node["scale"] = {1, 1, 0};
  EXPECT_TRUE(flat.load().smooth.empty());
}

TEST(Normals, TurnWithTheirNode) {
  Maker m;
  m.floats("NORMAL", kBent, 3);
  const double h = std::sqrt(0.5);
  m.node["rotation"] = {0, 0, h, h};  // a quarter about z: x becomes y
  expect_near(m.load().normals[0], {0, 0.6, 0.8});
}

TEST(Normals, StayInStepWithTrianglesThatAreDropped) {
  Maker m;
  m.floats("NORMAL", kBent, 3);
  m.b.material(m.material);
  const int indices = m.b.indices_u8({0, 0, 1, 0, 1, 2});
  m.b.mesh({{"attributes", m.attributes}, {"indices", indices}, {"material", 0}});
  m.b.node(m.node);
  const TempFolder folder;
  const Scene s = read_gltf(folder.write("scene.glb", m.b.glb()));
  EXPECT_EQ(s.triangles.size(), 1u);
  EXPECT_EQ(s.smooth, std::vector<uint8_t>{1});
}

TEST(Tangents, AreKeptForNormalMapsOnly) {
  for (const std::string map : {"baseColorTexture", "normalTexture"}) {
    Maker m(map);
    m.floats("NORMAL", kBent, 3);
    m.floats("TEXCOORD_0", {0, 0, 1, 0, 0, 1}, 2);
    m.floats("TANGENT", {2, 0, 0, 1, 0, 3, 0, -1, 0, 0, 0, 1}, 4);
    const Scene s = m.load();
    EXPECT_EQ(s.tangents.empty(), map == "baseColorTexture");
    if (s.tangents.empty()) continue;
    EXPECT_EQ(s.tangents[0], (std::array<float, 4>{1, 0, 0, 1}));
    EXPECT_EQ(s.tangents[1], (std::array<float, 4>{0, 1, 0, -1}));
    EXPECT_EQ(s.tangents[2], (std::array<float, 4>{0, 0, 0, 1}));
    EXPECT_EQ(needs_of(s), (Words{"textures", "shading normals", "normal maps"}));
  }
}

TEST(Tangents, MeanNothingWithoutNormals) {
  Maker m("normalTexture");
  m.floats("TEXCOORD_0", {0, 0, 1, 0, 0, 1}, 2);
  m.floats("TANGENT", {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, 4);
  EXPECT_TRUE(m.load().tangents.empty());
}

TEST(Tangents, AMirrorTurnsTheirHand) {
  Maker m("normalTexture");
  m.floats("NORMAL", kBent, 3);
  m.floats("TEXCOORD_0", {0, 0, 1, 0, 0, 1}, 2);
  m.floats("TANGENT", {0.6f, 0.8f, 0, 1, 1, 0, 0, -1, 1, 0, 0, 1}, 4);
  m.node["scale"] = {-2, 2, 2};
  const Scene s = m.load();
  expect_near({s.tangents[0][0], s.tangents[0][1], s.tangents[0][2]}, {-0.6, 0.8, 0});
  EXPECT_EQ(s.tangents[0][3], -1);
  EXPECT_EQ(s.tangents[1][3], 1);
}

using Pairs = std::vector<std::array<float, 2>>;

TEST(TextureCoordinates, OfEveryType) {
  const Pairs expected = {{0, 0}, {1, 0}, {0, 1}};
  const auto check = [&](auto&& fill, const Pairs& values) {
    Maker m("baseColorTexture");
    fill(m);
    const Scene s = m.load();
    ASSERT_EQ(s.uv[0].size(), 3u);
    for (size_t i = 0; i < 3; ++i)
      for (size_t c = 0; c < 2; ++c) EXPECT_NEAR(s.uv[0][i][c], values[i][c], 1e-6);
    EXPECT_TRUE(s.uv[1].empty());
  };
  const std::string name = "TEXCOORD_0";
  check([&](Maker& m) { m.floats(name, {0, 0, 1, 0, 0, 1}, 2); }, expected);
  check([&](Maker& m) { m.integers<uint8_t>(name, {0, 0, 255, 0, 0, 255}, 2, true, 4); }, expected);
  check(
      [&](Maker& m) {
        m.integers<uint16_t>(name, {0, 0, 65535, 0, 0, 65535}, 2, true, 4);
      },
      expected);
  check(
      [&](Maker& m) {
        m.integers<int8_t>(name, {0, 0, 127, 0, -128, 64}, 2, true, 4);
      },
      {{0, 0}, {1, 0}, {-1, 64 / 127.0f}});
  check(
      [&](Maker& m) {
        m.integers<int16_t>(name, {0, 0, 32767, 0, -32768, 1}, 2, true, 8);
      },
      {{0, 0}, {1, 0}, {-1, 1 / 32767.0f}});
  check(
      [&](Maker& m) {
        m.integers<uint8_t>(name, {0, 0, 3, 0, 0, 200}, 2, false, 4);
      },
      {{0, 0}, {3, 0}, {0, 200}});
  check(
      [&](Maker& m) {
        m.integers<int8_t>(name, {0, 0, 3, 0, 0, -5}, 2, false, 4);
      },
      {{0, 0}, {3, 0}, {0, -5}});
  check(
      [&](Maker& m) {
        m.integers<uint16_t>(name, {0, 0, 3, 0, 0, 60000}, 2, false, 12);
      },
      {{0, 0}, {3, 0}, {0, 60000}});
  check(
      [&](Maker& m) {
        m.integers<int16_t>(name, {0, 0, 3, 0, 0, -500}, 2, false, 4);
      },
      {{0, 0}, {3, 0}, {0, -500}});
}

TEST(TextureCoordinates, ThatAreMissingAreToldAndZero) {
  Maker m("baseColorTexture");
  m.floats("TEXCOORD_1", {0, 0, 1, 0, 0, 1}, 2);
  const Scene s = m.load();
  EXPECT_EQ(s.warnings,
            Words{"texture coordinates that a material asks for are missing, taken as 0: "
                  "meshes[0].primitives[0]"});
  // Half of each texel: they meet at 0.
  EXPECT_NEAR(lookup(s, s.materials[0].maps[MAP_BASE], {0, 0.2, 0.2})[3], 191.5 / 255, 1e-6);
}

TEST(Normals, OfEveryQuantizedType) {
  const auto first = [](auto&& fill) {
    Maker m;
    fill(m);
    return m.load().normals.at(0);
  };
  const Vec3d expected = normalize(Vec3d(60, 0, 80));
  expect_near(first([](Maker& m) {
                m.integers<int8_t>("NORMAL", {60, 0, 80, 0, 0, 1, 0, 0, 1}, 3, true, 4);
              }),
              expected);
  expect_near(first([](Maker& m) {
                m.integers<int16_t>("NORMAL", {600, 0, 800, 0, 0, 1, 0, 0, 1}, 3, true, 8);
              }),
              expected);
}

using Colours = std::vector<std::array<float, 4>>;

TEST(VertexColours, OfEveryType) {
  const auto colours = [](auto&& fill) {
    Maker m;
    fill(m);
    const Scene s = m.load();
    EXPECT_FALSE(s.materials[0].plain);
    EXPECT_EQ(needs_of(s), Words{"vertex colours"});
    EXPECT_EQ(s.warnings, Words{});
    return s.colours;
  };
  const Colours rgb = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 0.2f, 1}};
  const std::string name = "COLOR_0";
  EXPECT_EQ(colours([&](Maker& m) { m.floats(name, {1, 0, 0, 0, 1, 0, 0, 0, 0.2f}, 3); }), rgb);
  EXPECT_EQ(colours([&](Maker& m) {
              m.integers<uint8_t>(name, {255, 0, 0, 0, 255, 0, 0, 0, 51}, 3, true, 4);
            }),
            rgb);
  EXPECT_EQ(colours([&](Maker& m) {
              m.integers<uint16_t>(name, {65535, 0, 0, 0, 65535, 0, 0, 0, 13107}, 3, true, 8);
            }),
            rgb);
  EXPECT_EQ(colours([&](Maker& m) {
              m.floats(name, {1, 0, 0, 0.5f, 0, 1, 0, 2, 0, 0, 0.2f, -1}, 4);
            }),
            (Colours{{1, 0, 0, 0.5f}, {0, 1, 0, 1}, {0, 0, 0.2f, 0}}));
}

TEST(VertexColours, WhiteOrOfBlackCostNothing) {
  Maker white;
  white.floats("COLOR_0", std::vector<float>(9, 1), 3);
  EXPECT_TRUE(white.load().colours.empty());
  Maker alpha;  // an opaque material has no alpha
  alpha.floats("COLOR_0", {1, 1, 1, 0, 1, 1, 1, 0.5f, 1, 1, 1, 1}, 4);
  EXPECT_TRUE(alpha.load().colours.empty());
  Maker black;
  black.material["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 1};
  black.floats("COLOR_0", std::vector<float>(9, 0.5f), 3);
  const Scene s = black.load();
  EXPECT_TRUE(s.colours.empty());
  EXPECT_TRUE(s.materials[0].plain);
}

TEST(VertexColours, HaveAlpha) {
  for (float alpha : {0.25f, 1.0f}) {
    Maker m;
    m.material["alphaMode"] = "BLEND";
    m.floats("COLOR_0", {1, 1, 1, alpha, 1, 1, 1, 1, 0.5f, 1, 1, 1}, 4);
    const Scene s = m.load();
    EXPECT_EQ(s.materials[0].alpha_mode == Material::Alpha::opaque, alpha == 1);
    EXPECT_EQ(coverage_at(s, {0, 0, 0}), alpha);
  }
}

TEST(VertexColours, OfUnlitMaterialsAreTold) {
  Maker m;
  m.material["extensions"]["KHR_materials_unlit"] = Json::object();
  m.floats("COLOR_0", std::vector<float>(9, 0.5f), 3);
  const Scene s = m.load();
  EXPECT_EQ(s.warnings.back(),
            "vertex colours of unlit materials are left out: meshes[0].primitives[0]");
  EXPECT_TRUE(s.colours.empty());
}

TEST(VertexColours, AreFiniteWhateverTheFileHolds) {
  Maker m;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  m.floats("COLOR_0", {nan, inf, -inf, -1, 3e38f, 1, 0, 0, 0}, 3);
  m.b.json["accessors"][1].erase("min");
  m.b.json["accessors"][1].erase("max");
  for (float c : base_color_at(m.load(), {0, 0.3, 0.3})) EXPECT_TRUE(c >= 0 && c <= 1) << c;
}

TEST(Attributes, MayBeSparse) {
  for (bool on_zeros : {false, true}) {
    Maker m("baseColorTexture");
    m.floats("TEXCOORD_0", {9, 9, 0.5f, 0.25f, 7, 7}, 2);
    Json& a = m.b.json["accessors"].back();
    if (on_zeros) a.erase("bufferView");
    const int index = m.b.view(std::string("\0\2", 2));
    const int value = m.b.view(bytes_of(std::vector<float>{1, 2, 3, 4}));
    a["sparse"] = {{"count", 2},
                   {"indices", {{"bufferView", index}, {"componentType", 5121}}},
                   {"values", {{"bufferView", value}}}};
    EXPECT_EQ(
        m.load().uv[0],
        (Pairs{
            {1, 2}, on_zeros ? Pairs::value_type{0, 0} : Pairs::value_type{0.5f, 0.25f}, {3, 4}}));
  }
}

TEST(Attributes, PrimitivesShareVerticesWhereAllAgree) {
  const auto vertices = [](bool other_colour, bool coloured_material) {
    Maker m;
    m.b.material(m.material);
    if (!coloured_material)
      m.b.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 1};
    m.floats("COLOR_0", {1, 0, 0, 0, 1, 0, 0, 0, 1}, 3);
    Json second = m.attributes;
    if (other_colour) second["COLOR_0"] = m.b.floats(std::vector<float>(9, 0.5f), 3);
    m.b.mesh({{"attributes", m.attributes}, {"material", 0}});
    m.b.json["meshes"][0]["primitives"].push_back({{"attributes", second}, {"material", 0}});
    m.b.node(m.node);
    const TempFolder folder;
    const Scene s = read_gltf(folder.write("scene.glb", m.b.glb()));
    EXPECT_EQ(s.triangles.size(), 2u);
    EXPECT_TRUE(s.colours.empty() || s.colours.size() == s.positions.size());
    return s.positions.size();
  };
  EXPECT_EQ(vertices(false, true), 3u);
  EXPECT_EQ(vertices(true, true), 6u);
  EXPECT_EQ(vertices(true, false), 3u);  // attributes that are not read need not agree
}

TEST(Attributes, MeshesWithoutThemFillTheGap) {
  Maker m("baseColorTexture");
  m.b.material(m.material);
  m.b.mesh({{"attributes", m.attributes}, {"material", 0}});
  m.floats("NORMAL", kBent, 3);
  m.floats("COLOR_0", std::vector<float>(9, 0.5f), 3);
  m.floats("TEXCOORD_0", {1, 2, 3, 4, 5, 6}, 2);
  m.b.mesh({{"attributes", m.attributes}, {"material", 0}});
  for (int mesh : {0, 1, 0}) m.b.node({{"mesh", mesh}});
  const TempFolder folder;
  const Scene s = read_gltf(folder.write("scene.glb", m.b.glb()));
  EXPECT_EQ(s.smooth, (std::vector<uint8_t>{0, 1, 0}));
  ASSERT_EQ(s.normals.size(), 9u);
  ASSERT_EQ(s.colours.size(), 9u);
  ASSERT_EQ(s.uv[0].size(), 9u);
  for (size_t v = 0; v < 9; ++v) {
    const bool bare = v / 3 != 1;
    EXPECT_EQ(s.normals[v] == Vec3f{}, bare);
    EXPECT_EQ(s.colours[v][0], bare ? 1 : 0.5f);
    EXPECT_EQ(s.uv[0][v][0], bare ? 0 : static_cast<float>(2 * (v - 3) + 1));
  }
}

TEST(Attributes, ThatNothingAsksForAreNotRead) {
  Maker m;
  m.attributes["TEXCOORD_0"] = m.attributes["TANGENT"] = m.attributes["POSITION"];
  m.attributes["JOINTS_0"] = m.attributes["POSITION"];
  EXPECT_EQ(m.refusal(), "");
}

TEST(Attributes, OfOtherTypesAreRefused) {
  const auto refusal = [](const std::string& name, int type, const std::string& shape,
                          bool normalized = false) {
    Maker m("normalTexture");
    m.floats("NORMAL", kBent, 3);
    m.floats("TEXCOORD_0", {0, 0, 1, 0, 0, 1}, 2);
    const int a = m.b.accessor(m.b.view(std::string(48, '\0')), type, shape, 3);
    if (normalized) m.b.json["accessors"].back()["normalized"] = true;
    m.attributes[name] = a;
    return m.refusal();
  };
  EXPECT_EQ(refusal("TANGENT", 5126, "VEC3"), "accessors[3].type: tangents are not VEC4");
  EXPECT_EQ(refusal("COLOR_0", 5123, "VEC4"),
            "accessors[3].componentType: vertex colours are of type 5123, expected 5126 (float), "
            "or 5120 to 5123, normalized");
  EXPECT_EQ(refusal("COLOR_0", 5123, "VEC4", true), "");
}

}  // namespace tdpt::testing::attributes_test
