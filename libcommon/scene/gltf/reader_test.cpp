// Every encoding of the same surfaces gives the same triangles in the right places.
#include <gtest/gtest.h>
#include <cmath>
#include <cstring>
#include <numbers>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/glb_builder.h"
#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/rooms.h"

namespace tdpt::testing::reader_test {

using Json = nlohmann::ordered_json;
using Corners = std::vector<std::array<Vec3f, 3>>;

const std::string kTestdata = TDPT_TESTDATA;

Scene load(const std::string& bytes) {
  const TempFolder folder;
  return read_gltf(folder.write("scene.glb", bytes));
}

/// Canonical corners of all triangles, the smallest corner of each first.
Corners corners_of(const Scene& scene) {
  Corners out;
  const auto less = [](const Vec3f& a, const Vec3f& b) {
    return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
  };
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    std::array<Vec3f, 3> c{scene.vertex(t, 0), scene.vertex(t, 1), scene.vertex(t, 2)};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end(), less), c.end());
    out.push_back(c);
  }
  return out;
}

// A strip of four vertices, bent at the diagonal; a fan gives another pair of triangles.
const std::vector<float> kVertices = {0, 0, 0, 1, 0, 0.25f, 0, 1, 0.5f, 1, 1, 0};

std::string scene_of(GlbBuilder& b, Json primitive) {
  b.material({{"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
  primitive["material"] = 0;
  b.node({{"mesh", b.mesh(primitive)}});
  return b.glb();
}

Corners plain(const std::vector<uint16_t>& order) {
  GlbBuilder b;
  std::vector<float> positions;
  for (uint16_t v : order)
    for (size_t c = 0; c < 3; ++c) positions.push_back(kVertices[3 * v + c]);
  const int p = b.floats(positions, 3);
  return corners_of(load(scene_of(b, {{"attributes", {{"POSITION", p}}}})));
}
const std::vector<uint16_t> kPair = {0, 1, 2, 1, 3, 2};

TEST(Encodings, IndicesOfEverySize) {
  for (int size : {1, 2, 4}) {
    GlbBuilder b;
    const int p = b.floats(kVertices, 3);
    const int i = size == 1   ? b.indices_u8({0, 1, 2, 1, 3, 2})
                  : size == 2 ? b.indices_u16({0, 1, 2, 1, 3, 2})
                              : b.indices_u32({0, 1, 2, 1, 3, 2});
    EXPECT_EQ(corners_of(load(scene_of(b, {{"attributes", {{"POSITION", p}}}, {"indices", i}}))),
              plain(kPair))
        << size;
  }
}

TEST(Encodings, StripsTurnEverySecondTriangle) {
  GlbBuilder b;
  const int p = b.floats(kVertices, 3);
  EXPECT_EQ(corners_of(load(scene_of(b, {{"attributes", {{"POSITION", p}}}, {"mode", 5}}))),
            plain(kPair));
  GlbBuilder c;  // indexed
  const int q = c.floats(kVertices, 3);
  const int i = c.indices_u8({3, 2, 1, 0});
  EXPECT_EQ(corners_of(load(
                scene_of(c, {{"attributes", {{"POSITION", q}}}, {"indices", i}, {"mode", 5}}))),
            plain({3, 2, 1, 2, 0, 1}));
}

TEST(Encodings, FansShareTheirFirstVertex) {
  GlbBuilder b;
  const int p = b.floats(kVertices, 3);
  EXPECT_EQ(corners_of(load(scene_of(b, {{"attributes", {{"POSITION", p}}}, {"mode", 6}}))),
            plain({0, 1, 2, 0, 2, 3}));
}

TEST(Encodings, Interleaved) {
  GlbBuilder b;
  std::string bytes;
  for (size_t v = 0; v < 4; ++v) {
    bytes += std::string(8, '\x7f');  // unrelated bytes after each vertex
    bytes.append(reinterpret_cast<const char*>(&kVertices[3 * v]), 12);
  }
  const int p = b.accessor(b.view(bytes, 20), 5126, "VEC3", 4, 8);
  const int i = b.indices_u8({0, 1, 2, 1, 3, 2});
  EXPECT_EQ(corners_of(load(scene_of(b, {{"attributes", {{"POSITION", p}}}, {"indices", i}}))),
            plain(kPair));
}

TEST(Encodings, SparsePositions) {
  for (bool on_zeros : {false, true}) {
    GlbBuilder b;
    std::vector<float> wrong = kVertices;
    wrong[3] = 77, wrong[10] = -5;
    const int p = b.floats(wrong, 3);
    const std::vector<size_t> replaced =
        on_zeros ? std::vector<size_t>{0, 1, 2, 3} : std::vector<size_t>{1, 3};
    std::string index, value;
    for (size_t v : replaced) {
      index += static_cast<char>(v);
      value.append(reinterpret_cast<const char*>(&kVertices[3 * v]), 12);
    }
    Json& a = b.json["accessors"][static_cast<size_t>(p)];
    if (on_zeros) a.erase("bufferView");
    const int index_view = b.view(index), value_view = b.view(value);
    a["sparse"] = {{"count", replaced.size()},
                   {"indices", {{"bufferView", index_view}, {"componentType", 5121}}},
                   {"values", {{"bufferView", value_view}}}};
    const int i = b.indices_u8({0, 1, 2, 1, 3, 2});
    EXPECT_EQ(corners_of(load(scene_of(b, {{"attributes", {{"POSITION", p}}}, {"indices", i}}))),
              plain(kPair));
  }
}

TEST(Encodings, SparseIndices) {
  GlbBuilder b;
  const int p = b.floats(kVertices, 3);
  const int i = b.indices_u16({0, 1, 2, 1, 0, 0});
  const int index = b.view(std::string("\4\5", 2)), value = b.view(std::string("\3\0\2\0", 4));
  b.json["accessors"][static_cast<size_t>(i)]["sparse"] = {
      {"count", 2},
      {"indices", {{"bufferView", index}, {"componentType", 5121}}},
      {"values", {{"bufferView", value}}}};
  EXPECT_EQ(corners_of(load(scene_of(b, {{"attributes", {{"POSITION", p}}}, {"indices", i}}))),
            plain(kPair));
}

TEST(Encodings, DataUriAndBinaryChunkAreTheSame) {
  GlbBuilder b;
  const int p = b.floats(kVertices, 3);
  const std::string glb = scene_of(b, {{"attributes", {{"POSITION", p}}}, {"mode", 5}});
  EXPECT_EQ(corners_of(load(b.gltf())), corners_of(load(glb)));
}

TEST(Encodings, QuantizedPositions) {
  GlbBuilder b;
  b.json["extensionsUsed"] = Json::array({"KHR_mesh_quantization"});
  b.json["extensionsRequired"] = Json::array({"KHR_mesh_quantization"});
  const std::vector<int16_t> v = {0, 0, 0, 0, 4, 0, 1, 0, 0, 4, 2, 0, 4, 4, 0, 0};
  const int p = b.accessor(b.view({reinterpret_cast<const char*>(v.data()), 2 * v.size()}, 8), 5122,
                           "VEC3", 4);
  EXPECT_EQ(corners_of(load(scene_of(b, {{"attributes", {{"POSITION", p}}}, {"mode", 5}}))),
            plain(kPair));
}

TEST(Encodings, IntegersMayBeWrittenAsDecimals) {
  GlbBuilder b;
  const int p = b.floats(kVertices, 3);
  b.json["accessors"][0]["count"] = 4.0;
  EXPECT_EQ(load(scene_of(b, {{"attributes", {{"POSITION", p}}}, {"mode", 5}})).triangles.size(),
            2u);
}

TEST(Encodings, PointsLinesAndFlatTrianglesAreLeftOut) {
  GlbBuilder b;
  const int p = b.floats(kVertices, 3);
  const int flat = b.indices_u8({0, 1, 2, 1, 1, 2});
  const Json at = {{"POSITION", p}};
  b.node({{"mesh", b.mesh({{"attributes", at}, {"mode", 1}})}});
  const Scene s = load(scene_of(b, {{"attributes", at}, {"indices", flat}}));
  EXPECT_EQ(s.triangles.size(), 1u);
  EXPECT_EQ(s.warnings, std::vector<std::string>{"1 triangle without area: left out"});
}

/// One triangle (0,0,0) (2,0,0) (0,1,0), placed by nodes that a test adds.
GlbBuilder triangle() {
  GlbBuilder b;
  const int p = b.floats({0, 0, 0, 2, 0, 0, 0, 1, 0}, 3);
  b.mesh({{"attributes", {{"POSITION", p}}}});
  return b;
}
Vec3d metres(const Scene& s, uint32_t t, int corner) {
  return s.frame.to_metres(Vec3d(s.vertex(t, corner)));
}
void expect_near(const Vec3d& a, const Vec3d& b) {
  EXPECT_LT(length(a - b), 1e-6);
}

TEST(Nodes, TransformsMultiplyFromTheRootDown) {
  GlbBuilder b = triangle();
  const double h = std::sqrt(0.5);
  // Scale by 2, quarter turn about z, then 3 to the right; its parent translates by 10 upwards.
  b.json["nodes"] = {
      {{"translation", {0, 10, 0}}, {"children", {1}}},
      {{"translation", {3, 0, 0}}, {"rotation", {0, 0, h, h}}, {"scale", {2, 2, 2}}, {"mesh", 0}}};
  b.json["scenes"][0]["nodes"] = {0};
  const Scene s = load(b.glb());
  expect_near(metres(s, 0, 0), {3, 10, 0});
  expect_near(metres(s, 0, 1), {3, 14, 0});
  expect_near(metres(s, 0, 2), {1, 10, 0});
}

TEST(Nodes, MatrixAndItsPartsAreTheSame) {
  GlbBuilder a = triangle(), b = triangle();
  a.node({{"mesh", 0}, {"translation", {1, 2, 3}}, {"scale", {2, 3, 4}}});
  b.node({{"mesh", 0}, {"matrix", {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0, 1, 2, 3, 1}}});
  EXPECT_EQ(corners_of(load(a.glb())), corners_of(load(b.glb())));
}

TEST(Nodes, MirroringKeepsTheFront) {
  for (const std::array<double, 3>& scale : std::vector<std::array<double, 3>>{
           {-1, 1, 1}, {1, -1, 1}, {-1e-8, 1e-8, 1e-8}, {-1, -1, 1}}) {
    GlbBuilder b = triangle();
    b.node({{"mesh", 0}, {"scale", scale}});
    // Mirrored in x or y the triangle stays in its plane, and its front still faces +z.
    EXPECT_GT(shape_of(load(b.glb()), 0).normal.z, 0.999);
  }
  GlbBuilder b = triangle();
  b.node({{"mesh", 0}, {"scale", {1, 1, -1}}});
  EXPECT_LT(shape_of(load(b.glb()), 0).normal.z, -0.999);
  GlbBuilder twice = triangle();  // two mirrorings cancel
  twice.json["nodes"] = {{{"scale", {-1, 1, 1}}, {"children", {1}}},
                         {{"scale", {1, -1, 1}}, {"mesh", 0}}};
  twice.json["scenes"][0]["nodes"] = {0};
  EXPECT_GT(shape_of(load(twice.glb()), 0).normal.z, 0.999);
}

TEST(Nodes, DeepNestingDoesNotRunOutOfStack) {
  GlbBuilder b = triangle();
  const int depth = 200000;
  for (int i = 0; i < depth; ++i) b.json["nodes"].push_back({{"children", {i + 1}}});
  b.json["nodes"].push_back({{"mesh", 0}});
  b.json["scenes"][0]["nodes"] = {0};
  EXPECT_EQ(load(b.glb()).triangles.size(), 1u);
}

TEST(Nodes, OnlyTheDefaultSceneIsRead) {
  GlbBuilder b = triangle();
  b.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {5, 0, 0}}}, {{"mesh", 0}}};
  b.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1, 2}}}};
  b.json["scene"] = 1;
  EXPECT_EQ(load(b.glb()).triangles.size(), 2u);
  b.json.erase("scene");  // then the first
  EXPECT_EQ(load(b.glb()).triangles.size(), 1u);
  b.json.erase("scenes");  // then every root
  EXPECT_EQ(load(b.glb()).triangles.size(), 3u);
}

TEST(CanonicalFrame, LongestSideInOneToTwoAndCentred) {
  for (double size : {1e-6, 0.3, 1.0, 1.5, 2.0, 3.999, 4.0, 1e7}) {
    GlbBuilder b = triangle();
    b.node({{"mesh", 0}, {"scale", {size / 2, size / 2, size / 2}}, {"translation", {1, 2, 3}}});
    const Scene s = load(b.glb());
    Vec3d lo(1e9), hi(-1e9);
    for (int c = 0; c < 3; ++c)
      lo = min(lo, Vec3d(s.vertex(0, c))), hi = max(hi, Vec3d(s.vertex(0, c)));
    EXPECT_GT(hi.x - lo.x, 1 - 1e-9) << size;
    EXPECT_LE(hi.x - lo.x, 2) << size;
    EXPECT_NEAR(hi.x + lo.x, 0, 1e-7) << size;
    int exponent;
    EXPECT_EQ(std::frexp(s.frame.scale, &exponent), 0.5) << size;
  }
}

std::string scaled(const std::string& glb, double factor) {
  const size_t json_size =
      static_cast<unsigned char>(glb[12]) + 256 * static_cast<unsigned char>(glb[13]);
  Json j = Json::parse(glb.substr(20, json_size));
  const size_t root = j["nodes"].size();
  j["nodes"].push_back(
      {{"scale", {factor, factor, factor}}, {"children", j["scenes"][0]["nodes"]}});
  j["scenes"][0]["nodes"] = {root};
  return glb_of(j.dump(), glb.substr(20 + json_size + 8));
}

TEST(CanonicalFrame, ScalingByAPowerOfTwoChangesNoBit) {
  for (const NamedScene& room : make_scenes()) {
    const Scene a = load(room.bytes);
    for (double factor : {0x1p-20, 0.5, 2.0, 1024.0}) {
      const Scene b = load(scaled(room.bytes, factor));
      EXPECT_EQ(a.positions, b.positions) << room.file;
      EXPECT_EQ(a.frame.scale, b.frame.scale * factor) << room.file;
      EXPECT_EQ(a.frame.centre * factor, b.frame.centre) << room.file;
      EXPECT_EQ(a.camera("").position, b.camera("").position) << room.file;
    }
  }
  // Twin: any other factor is detected.
  const std::string bytes = make_scenes()[0].bytes;
  EXPECT_NE(load(bytes).positions, load(scaled(bytes, 1.1)).positions);
}

TEST(CanonicalFrame, NothingIsLostFarFromTheOrigin) {
  const std::string glb = make_scenes()[0].bytes;
  const size_t json_size =
      static_cast<unsigned char>(glb[12]) + 256 * static_cast<unsigned char>(glb[13]);
  Json j = Json::parse(glb.substr(20, json_size));
  const size_t root = j["nodes"].size();
  j["nodes"].push_back({{"translation", {1e6, -3e6, 2e6}}, {"children", j["scenes"][0]["nodes"]}});
  j["scenes"][0]["nodes"] = {root};
  const Scene a = load(glb), b = load(glb_of(j.dump(), glb.substr(20 + json_size + 8)));
  ASSERT_EQ(a.positions.size(), b.positions.size());
  for (size_t i = 0; i < a.positions.size(); ++i)
    EXPECT_LT(length(Vec3d(a.positions[i]) - Vec3d(b.positions[i])), 3e-7);
}

TEST(Cameras, PlaceAxesAndNames) {
  GlbBuilder b = triangle();
  b.node({{"mesh", 0}});
  b.camera("hall", {1, 2, 3}, {1, 2, -5}, 0.7, 1.5);
  b.camera("", {0, 0, 4}, {4, 0, 4}, 0.9, 1);
  b.camera("hall", {0, 5, 0}, {0, 5, 1}, 1, 1);
  b.json["cameras"].push_back({{"name", "plan"}, {"type", "orthographic"}});
  b.node({{"camera", 3}});
  b.json["nodes"][1]["scale"] = {-2, 3, 5};  // a camera ignores scale
  const Scene s = load(b.glb());
  ASSERT_EQ(s.cameras.size(), 3u);
  EXPECT_EQ(&s.camera(""), &s.cameras[0]);
  const Camera& hall = s.camera("hall");
  expect_near(s.frame.to_metres(hall.position), {1, 2, 3});
  expect_near(hall.forward, {0, 0, -1});
  expect_near(hall.right, {1, 0, 0});
  expect_near(hall.up, {0, 1, 0});
  EXPECT_DOUBLE_EQ(hall.yfov, 0.7);
  EXPECT_DOUBLE_EQ(hall.aspect, 1.5);
  expect_near(s.camera("camera").forward, {1, 0, 0});
  expect_near(s.camera("camera").right, {0, 0, 1});
  expect_near(s.camera("hall.1").forward, {0, 0, 1});
  EXPECT_EQ(s.warnings.back(), "orthographic cameras are left out: nodes[4]");
  try {
    s.camera("attic");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("scene.glb:cameras: there is no camera \"attic\", "
                                         "expected one of \"hall\", \"camera\", \"hall.1\""),
              std::string::npos)
        << e.what();
  }
}

TEST(Cameras, ASceneMayHaveNone) {
  GlbBuilder b = triangle();
  b.node({{"mesh", 0}});
  const Scene s = load(b.glb());
  EXPECT_TRUE(s.cameras.empty());
  try {
    s.camera("");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("the scene has no perspective camera"), std::string::npos);
  }
}

TEST(Shapes, AreaNormalAndCorners) {
  GlbBuilder b = triangle();
  b.node({{"mesh", 0}});
  const Scene s = load(b.glb());
  const TriangleShape t = shape_of(s, 0);
  EXPECT_DOUBLE_EQ(t.area, 1 * s.frame.scale * s.frame.scale);
  EXPECT_EQ(t.normal, Vec3d(0, 0, 1));
  expect_near(t.p0 + t.e1, Vec3d(s.vertex(0, 1)));
}

}  // namespace tdpt::testing::reader_test
