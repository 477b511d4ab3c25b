// Normals, tangents, texture coordinates and vertex colours in every encoding.
#include <gtest/gtest.h>
#include <cmath>
#include <limits>

#include "libcommon/base/error.h"
#include "libcommon/scene/texture.h"
#include "libcommon/testing/scenes/materials.h"
#include "libcommon/testing/scenes/needs.h"

namespace tdpt::testing::attributes_test {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();
const std::vector<float> kBent = {0.6f, 0, 0.8f, 0, 0.6f, 0.8f, 0, 0, 1};
const std::vector<float> kUv = {0, 0, 1, 0, 0, 1};

/// A triangle in the plane z = 0 with a material that uses `map` ("baseColorTexture", ...).
struct Maker {
  GlbBuilder b;
  Json attributes, node = {{"mesh", 0}}, material = lambert(0.5, 0.5, 0.5);

  explicit Maker(const std::string& map = "") {
    attributes["POSITION"] = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
    if (map.empty()) return;
    (map == "normalTexture" ? material
                            : material["pbrMetallicRoughness"])[map] = {{"index", b.texture(kTwo)}};
  }
  /// `stride`: of the three elements.
  template <class T>
  void integers(const std::string& name, const std::vector<T>& values, bool normalized,
                size_t stride) {
    const int type = (sizeof(T) == 1 ? 5120 : 5122) + std::is_unsigned_v<T>;
    const size_t components = values.size() / 3, size = components * sizeof(T);
    std::string bytes;
    for (size_t i = 0; i < 3; ++i)
      bytes += bytes_of(values).substr(i * size, size) + std::string(stride - size, '\x7f');
    attributes[name] = b.accessor(b.view(bytes, static_cast<int>(stride)), type,
                                  "VEC" + std::to_string(components), 3);
    if (normalized) b.json["accessors"].back()["normalized"] = true;
  }
  void floats(const std::string& name, const std::vector<float>& values) {
    attributes[name] = b.floats(values, static_cast<int>(values.size() / 3));
    b.json["accessors"].back().erase("min");  // JSON has no NaN for the limits
    b.json["accessors"].back().erase("max");
  }
  Scene load() {
    b.material(material);
    b.mesh({{"attributes", attributes}, {"material", 0}});
    b.node(node);
    return testing::load(b);
  }
};

Maker with_floats(const std::string& name, const std::vector<float>& values,
                  const std::string& map = "") {
  Maker m(map);
  m.floats(name, values);
  return m;
}

void expect_near(const Vec3f& a, const Vec3d& b) {
  EXPECT_LT(length(Vec3d(a) - b), 1e-6) << a.x << " " << a.y << " " << a.z;
}

TEST(Normals, AreKeptWhereSomeTriangleIsSmooth) {
  const Scene s = with_floats("NORMAL", kBent).load();
  ASSERT_EQ(s.normals.size(), 3u);
  expect_near(s.normals[0], {0.6, 0, 0.8});
  EXPECT_EQ(s.smooth, std::vector<uint8_t>{1});
  EXPECT_EQ(needs_of(s), Sentences{"shading normals"});
  EXPECT_TRUE(s.materials[0].plain);
  const Scene back =
      with_floats("NORMAL", {0.6f, 0, -0.8f, 0, 0.6f, -0.8f, 0, 0, -1}).load();  // turned round
  EXPECT_EQ(back.smooth, std::vector<uint8_t>{2});
  expect_near(Vec3f(shading_normal_at(back, {0, 0, 0}, {0, 0, 1})), {-0.6, 0, 0.8});
}

TEST(Normals, FlatAndBadOnesLeaveTheTriangleFlat) {
  for (const std::vector<float>& n :
       {std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1},
        std::vector<float>{0, 0, -1, 0, 0, -1, 0, 0, -1},  // on the back: flipped
        std::vector<float>{9e-4f, 0, 1, 0, 9e-4f, 1, 0, 0, 5}}) {
    const Scene s = with_floats("NORMAL", n).load();
    EXPECT_TRUE(s.normals.empty() && s.smooth.empty());
    EXPECT_EQ(needs_of(s), Sentences{});
  }
  for (const float bad : {0.0f, kNan, kInfinite})
    EXPECT_TRUE(
        with_floats("NORMAL", {0.6f, 0, 0.8f, bad, bad, bad, 0, 0, 1}).load().smooth.empty());
}

TEST(Normals, GoAlongByTheInverseTranspose) {
  const auto first = [](const char* member, const Json& value) {
    Maker m = with_floats("NORMAL", kBent);
    m.node[member] = value;
    const Scene s = m.load();
    return s.normals.empty() ? Vec3f{} : s.normals[0];
  };
  expect_near(first("scale", {2, 1, 1}), normalize(Vec3d(0.3, 0, 0.8)));
  expect_near(first("scale", {1, 1, 4}), normalize(Vec3d(0.6, 0, 0.2)));
  expect_near(first("scale", {-1, 1, 1}), {-0.6, 0, 0.8});  // the front stays the front
  expect_near(first("scale", {1, 1, -1}), {0.6, 0, -0.8});
  expect_near(first("scale", {1e-12, 1e-12, 1e-12}), {0.6, 0, 0.8});
  expect_near(first("scale", {1e12, 1e12, 2e12}), normalize(Vec3d(0.6, 0, 0.4)));
  expect_near(first("scale", {1, 1, 0}), {0, 0, 0});  // a flat map has no inverse
  const double h = std::sqrt(0.5);
  expect_near(first("rotation", {0, 0, h, h}), {0, 0.6, 0.8});  // a quarter about z: x becomes y
}

TEST(Normals, StayInStepWithTrianglesThatAreDropped) {
  Maker m = with_floats("NORMAL", kBent);
  const int indices = m.b.indices_u8({0, 0, 1, 0, 1, 2});
  m.b.json["meshes"].push_back(
      {{"primitives", {{{"attributes", m.attributes}, {"indices", indices}, {"material", 0}}}}});
  const Scene s = m.load();
  EXPECT_EQ(s.triangles.size(), 1u);
  EXPECT_EQ(s.smooth, std::vector<uint8_t>{1});
}

TEST(Tangents, AreKeptForNormalMapsAndNormalsOnly) {
  const auto read = [](const std::string& map, bool normals, const Json& scale) {
    Maker m = with_floats("TEXCOORD_0", kUv, map);
    if (normals) m.floats("NORMAL", kBent);
    m.floats("TANGENT", {2, 0, 0, 1, 0, 3, 0, -1, 0, 0, 0, 1});
    m.node["scale"] = scale;
    return m.load();
  };
  EXPECT_TRUE(read("baseColorTexture", true, {1, 1, 1}).tangents.empty());
  EXPECT_TRUE(read("normalTexture", false, {1, 1, 1}).tangents.empty());
  const Scene s = read("normalTexture", true, {1, 1, 1});
  using Tangents = std::vector<std::array<float, 4>>;
  EXPECT_EQ(s.tangents, (Tangents{{1, 0, 0, 1}, {0, 1, 0, -1}, {0, 0, 0, 1}}));
  EXPECT_EQ(needs_of(s), (Sentences{"textures", "shading normals", "normal maps"}));
  const Scene mirrored = read("normalTexture", true, {-2, 2, 2});  // a mirror turns their hand
  EXPECT_EQ(mirrored.tangents, (Tangents{{-1, 0, 0, -1}, {0, 1, 0, 1}, {0, 0, 0, -1}}));
}

using Pairs = std::vector<std::array<float, 2>>;

TEST(TextureCoordinates, OfEveryType) {
  const auto check = [&](const Maker& maker, const Pairs& expected) {
    Maker m = maker;
    const Scene s = m.load();
    ASSERT_EQ(s.uv[0].size(), 3u);
    for (size_t i = 0; i < 3; ++i)
      for (size_t c = 0; c < 2; ++c) EXPECT_NEAR(s.uv[0][i][c], expected[i][c], 1e-6);
    EXPECT_TRUE(s.uv[1].empty());
  };
  const auto integers = [&](const auto& values, bool normalized, size_t stride) {
    Maker m("baseColorTexture");
    m.integers("TEXCOORD_0", values, normalized, stride);
    return m;
  };
  using U8 = std::vector<uint8_t>;
  using I8 = std::vector<int8_t>;
  using U16 = std::vector<uint16_t>;
  using I16 = std::vector<int16_t>;
  check(with_floats("TEXCOORD_0", kUv, "baseColorTexture"), {{0, 0}, {1, 0}, {0, 1}});
  check(integers(U8{0, 0, 255, 0, 0, 255}, true, 4), {{0, 0}, {1, 0}, {0, 1}});
  check(integers(U16{0, 0, 65535, 0, 0, 65535}, true, 4), {{0, 0}, {1, 0}, {0, 1}});
  check(integers(I8{0, 0, 127, 0, -128, 64}, true, 4), {{0, 0}, {1, 0}, {-1, 64 / 127.0f}});
  check(integers(I16{0, 0, 32767, 0, -32768, 1}, true, 8), {{0, 0}, {1, 0}, {-1, 1 / 32767.0f}});
  check(integers(U8{0, 0, 3, 0, 0, 200}, false, 4), {{0, 0}, {3, 0}, {0, 200}});
  check(integers(I8{0, 0, 3, 0, 0, -5}, false, 4), {{0, 0}, {3, 0}, {0, -5}});
  check(integers(U16{0, 0, 3, 0, 0, 60000}, false, 12), {{0, 0}, {3, 0}, {0, 60000}});
  check(integers(I16{0, 0, 3, 0, 0, -500}, false, 4), {{0, 0}, {3, 0}, {0, -500}});
}

TEST(TextureCoordinates, ThatAreMissingAreToldAndZero) {
  const Scene s = with_floats("TEXCOORD_1", kUv, "baseColorTexture").load();
  EXPECT_EQ(s.warnings,
            Sentences{"texture coordinates that a material asks for are missing, taken as 0: "
                      "meshes[0].primitives[0]"});
  // Half of each texel: they meet at 0.
  EXPECT_NEAR(lookup(s, s.materials[0].maps[MAP_BASE], {0, 0.2, 0.2})[3], 191.5 / 255, 1e-6);
}

using Colours = std::vector<std::array<float, 4>>;

TEST(VertexColours, OfEveryType) {
  const auto check = [](const Maker& maker, const Colours& expected) {
    Maker m = maker;
    const Scene s = m.load();
    EXPECT_EQ(s.colours, expected);
    EXPECT_FALSE(s.materials[0].plain);
    EXPECT_EQ(needs_of(s), Sentences{"vertex colours"});
    EXPECT_EQ(s.warnings, Sentences{});
  };
  const Colours rgb = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 0.2f, 1}};
  check(with_floats("COLOR_0", {1, 0, 0, 0, 1, 0, 0, 0, 0.2f}), rgb);
  check(with_floats("COLOR_0", {1, 0, 0, 0.5f, 0, 1, 0, 2, 0, 0, 0.2f, -1}),
        {{1, 0, 0, 0.5f}, {0, 1, 0, 1}, {0, 0, 0.2f, 0}});
  Maker bytes;
  bytes.integers<uint8_t>("COLOR_0", {255, 0, 0, 0, 255, 0, 0, 0, 51}, true, 4);
  check(bytes, rgb);
}

TEST(VertexColours, WhiteOrOfBlackCostNothing) {
  EXPECT_TRUE(with_floats("COLOR_0", std::vector<float>(9, 1)).load().colours.empty());
  Maker alpha = with_floats("COLOR_0", {1, 1, 1, 0, 1, 1, 1, 0.5f, 1, 1, 1, 1});
  EXPECT_TRUE(alpha.load().colours.empty()) << "an opaque material has no alpha";
  Maker black = with_floats("COLOR_0", std::vector<float>(9, 0.5f));
  black.material["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 1};
  const Scene s = black.load();
  EXPECT_TRUE(s.colours.empty());
  EXPECT_TRUE(s.materials[0].plain);
}

TEST(VertexColours, HaveAlpha) {
  for (const float alpha : {0.25f, 1.0f}) {
    Maker m = with_floats("COLOR_0", {1, 1, 1, alpha, 1, 1, 1, 1, 0.5f, 1, 1, 1});
    m.material["alphaMode"] = "BLEND";
    const Scene s = m.load();
    EXPECT_EQ(s.materials[0].alpha_mode == Material::Alpha::opaque, alpha == 1);
    EXPECT_EQ(coverage_at(s, {0, 0, 0}), alpha);
  }
}

TEST(VertexColours, OfUnlitMaterialsAreTold) {
  Maker m = with_floats("COLOR_0", std::vector<float>(9, 0.5f));
  m.material["extensions"]["KHR_materials_unlit"] = Json::object();
  const Scene s = m.load();
  EXPECT_EQ(s.warnings.back(),
            "vertex colours of unlit materials are left out: meshes[0].primitives[0]");
  EXPECT_TRUE(s.colours.empty());
}

TEST(VertexColours, AreFiniteWhateverTheFileHolds) {
  Maker m = with_floats("COLOR_0", {kNan, kInfinite, -kInfinite, -1, 3e38f, 1, 0, 0, 0});
  for (float c : base_color_at(m.load(), {0, 0.3, 0.3})) EXPECT_TRUE(c >= 0 && c <= 1) << c;
}

TEST(Attributes, PrimitivesShareVerticesWhereAllAgree) {
  const auto vertices = [](bool other_colour, bool coloured_material) {
    Maker m = with_floats("COLOR_0", {1, 0, 0, 0, 1, 0, 0, 0, 1});
    if (!coloured_material) m.material["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 1};
    Json second = m.attributes;
    if (other_colour) second["COLOR_0"] = m.b.floats(std::vector<float>(9, 0.5f), 3);
    m.b.mesh({{"attributes", second}, {"material", 0}});
    m.b.json["meshes"][0]["primitives"].push_back({{"attributes", m.attributes}, {"material", 0}});
    const Scene s = m.load();
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
  m.b.mesh({{"attributes", m.attributes}, {"material", 0}});
  m.floats("NORMAL", kBent);
  m.floats("COLOR_0", std::vector<float>(9, 0.5f));
  m.floats("TEXCOORD_0", {1, 2, 3, 4, 5, 6});
  m.b.node({{"mesh", 0}});
  m.b.node({{"mesh", 1}});
  const Scene s = m.load();  // mesh 1, and mesh 0 again
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
  EXPECT_NO_THROW(m.load());
}

}  // namespace tdpt::testing::attributes_test
