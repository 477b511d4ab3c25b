// Every encoding of the same surfaces gives the same triangles in the right places.
#include <gtest/gtest.h>
#include <cmath>
#include <functional>

#include "libcommon/testing/rooms/rooms.h"
#include "libcommon/testing/scenes/materials.h"

namespace tdpt::testing::reader_test {

using Corners = std::vector<std::array<Vec3f, 3>>;

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

/// The strip as `change` writes it: positions are accessors[0] of `primitive`.
Corners encoded(const std::function<void(GlbBuilder& b, Json& primitive)>& change) {
  GlbBuilder b;
  b.material(lambert(0.5, 0.5, 0.5));
  b.floats(kVertices, 3);
  Json primitive = {{"attributes", {{"POSITION", 0}}}, {"material", 0}};
  change(b, primitive);
  b.node({{"mesh", b.mesh(primitive)}});
  return corners_of(load(b));
}

/// These corners, without indices.
Corners plain(const std::vector<uint16_t>& order) {
  return encoded([&](GlbBuilder& b, Json& primitive) {
    std::vector<float> positions;
    for (uint16_t v : order)
      for (size_t c = 0; c < 3; ++c) positions.push_back(kVertices[3 * v + c]);
    primitive["attributes"]["POSITION"] = b.floats(positions, 3);
  });
}
Corners strip_pair() {
  return plain({0, 1, 2, 1, 3, 2});
}

TEST(Encodings, IndicesOfEverySize) {
  EXPECT_EQ(encoded([](GlbBuilder& b, Json& p) {
              p["indices"] = b.indices_u8({0, 1, 2, 1, 3, 2});
            }),
            strip_pair());
  EXPECT_EQ(encoded([](GlbBuilder& b, Json& p) {
              p["indices"] = b.indices_u16({0, 1, 2, 1, 3, 2});
            }),
            strip_pair());
  EXPECT_EQ(encoded([](GlbBuilder& b, Json& p) {
              p["indices"] = b.indices_u32({0, 1, 2, 1, 3, 2});
            }),
            strip_pair());
}

TEST(Encodings, StripsTurnEverySecondTriangleAndFansShareTheirFirstVertex) {
  EXPECT_EQ(encoded([](GlbBuilder&, Json& p) { p["mode"] = 5; }), strip_pair());
  EXPECT_EQ(encoded([](GlbBuilder& b, Json& p) {
              p["indices"] = b.indices_u8({3, 2, 1, 0}), p["mode"] = 5;
            }),
            plain({3, 2, 1, 2, 0, 1}));
  EXPECT_EQ(encoded([](GlbBuilder&, Json& p) { p["mode"] = 6; }), plain({0, 1, 2, 0, 2, 3}));
}

TEST(Encodings, InterleavedAndQuantizedPositions) {
  EXPECT_EQ(encoded([](GlbBuilder& b, Json& p) {
              std::string bytes;
              for (size_t v = 0; v < 4; ++v)  // unrelated bytes before each vertex
                bytes += std::string(8, '\x7f') + bytes_of(kVertices).substr(12 * v, 12);
              p["attributes"]["POSITION"] = b.accessor(b.view(bytes, 20), 5126, "VEC3", 4, 8);
              p["mode"] = 5;
            }),
            strip_pair());
  EXPECT_EQ(encoded([](GlbBuilder& b, Json& p) {
              b.json["extensionsRequired"] = Json::array({"KHR_mesh_quantization"});
              const std::vector<int16_t> v = {0, 0, 0, 0, 4, 0, 1, 0, 0, 4, 2, 0, 4, 4, 0, 0};
              p["attributes"]["POSITION"] = b.accessor(b.view(bytes_of(v), 8), 5122, "VEC3", 4);
              p["mode"] = 5;
            }),
            strip_pair());
}

TEST(Encodings, SparsePositionsAndIndices) {
  const auto sparse = [](GlbBuilder& b, size_t accessor, const std::string& index, size_t size,
                         const std::string& values) {
    const int index_view = b.view(index), value_view = b.view(values);
    b.json["accessors"][accessor]["sparse"] = {
        {"count", values.size() / size},
        {"indices", {{"bufferView", index_view}, {"componentType", 5121}}},
        {"values", {{"bufferView", value_view}}}};
  };
  EXPECT_EQ(encoded([&](GlbBuilder& b, Json& p) {
              std::vector<float> wrong = kVertices;
              wrong[3] = 77, wrong[10] = -5;
              p["attributes"]["POSITION"] = b.floats(wrong, 3);
              const std::string right = bytes_of(kVertices);
              sparse(b, 1, "\1\3", 12, right.substr(12, 12) + right.substr(36, 12));
              p["mode"] = 5;
            }),
            strip_pair());
  EXPECT_EQ(encoded([&](GlbBuilder& b, Json& p) {  // on zeros
              b.json["accessors"][0].erase("bufferView");
              sparse(b, 0, std::string("\0\1\2\3", 4), 12, bytes_of(kVertices));
              p["mode"] = 5;
            }),
            strip_pair());
  EXPECT_EQ(encoded([&](GlbBuilder& b, Json& p) {
              p["indices"] = b.indices_u16({0, 1, 2, 1, 0, 0});
              sparse(b, 1, "\4\5", 2, std::string("\3\0\2\0", 4));
            }),
            strip_pair());
}

TEST(Encodings, DataUriBinaryChunkAndDecimalsAreTheSame) {
  GlbBuilder b;
  b.floats(kVertices, 3);
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", 0}}}, {"mode", 5}})}});
  b.json["accessors"][0]["count"] = 4.0;
  const TempFolder folder;
  EXPECT_EQ(corners_of(read_gltf(folder.write("scene.gltf", b.gltf()))), strip_pair());
  EXPECT_EQ(corners_of(load(b)), strip_pair());
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
  const Scene s = load(b);
  expect_near(metres(s, 0, 0), {3, 10, 0});
  expect_near(metres(s, 0, 1), {3, 14, 0});
  expect_near(metres(s, 0, 2), {1, 10, 0});
}

TEST(Nodes, MatrixAndItsPartsAreTheSame) {
  GlbBuilder a = triangle(), b = triangle();
  a.node({{"mesh", 0}, {"translation", {1, 2, 3}}, {"scale", {2, 3, 4}}});
  b.node({{"mesh", 0}, {"matrix", {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0, 1, 2, 3, 1}}});
  EXPECT_EQ(corners_of(load(a)), corners_of(load(b)));
}

TEST(Nodes, MirroringKeepsTheFront) {
  for (const std::array<double, 3>& scale : std::vector<std::array<double, 3>>{
           {-1, 1, 1}, {1, -1, 1}, {-1e-8, 1e-8, 1e-8}, {-1, -1, 1}}) {
    GlbBuilder b = triangle();
    b.node({{"mesh", 0}, {"scale", scale}});
    // Mirrored in x or y the triangle stays in its plane, and its front still faces +z.
    EXPECT_GT(shape_of(load(b), 0).normal.z, 0.999);
  }
  GlbBuilder b = triangle();
  b.node({{"mesh", 0}, {"scale", {1, 1, -1}}});
  EXPECT_LT(shape_of(load(b), 0).normal.z, -0.999);
  GlbBuilder twice = triangle();  // two mirrorings cancel
  twice.json["nodes"] = {{{"scale", {-1, 1, 1}}, {"children", {1}}},
                         {{"scale", {1, -1, 1}}, {"mesh", 0}}};
  twice.json["scenes"][0]["nodes"] = {0};
  EXPECT_GT(shape_of(load(twice), 0).normal.z, 0.999);
}

TEST(Nodes, DeepNestingDoesNotRunOutOfStack) {
  GlbBuilder b = triangle();
  const int depth = 200000;
  for (int i = 0; i < depth; ++i) b.json["nodes"].push_back({{"children", {i + 1}}});
  b.json["nodes"].push_back({{"mesh", 0}});
  b.json["scenes"][0]["nodes"] = {0};
  EXPECT_EQ(load(b).triangles.size(), 1u);
}

TEST(Nodes, OnlyTheDefaultSceneIsRead) {
  GlbBuilder b = triangle();
  b.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {5, 0, 0}}}, {{"mesh", 0}}};
  b.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1, 2}}}};
  b.json["scene"] = 1;
  EXPECT_EQ(load(b).triangles.size(), 2u);
  b.json.erase("scene");  // then the first
  EXPECT_EQ(load(b).triangles.size(), 1u);
  b.json.erase("scenes");  // then every root
  EXPECT_EQ(load(b).triangles.size(), 3u);
}

TEST(CanonicalFrame, LongestSideInOneToTwoAndCentred) {
  for (double size : {1e-6, 0.3, 1.0, 1.5, 2.0, 3.999, 4.0, 1e7}) {
    GlbBuilder b = triangle();
    b.node({{"mesh", 0}, {"scale", {size / 2, size / 2, size / 2}}, {"translation", {1, 2, 3}}});
    const Scene s = load(b);
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

/// The scene below another node.
Scene load_below(const std::string& glb, Json node) {
  GlbBuilder b = GlbBuilder::of(glb);
  node["children"] = b.json["scenes"][0]["nodes"];
  b.json["scenes"][0]["nodes"] = Json::array();
  b.node(node);
  return load(b);
}
Scene scaled(const std::string& glb, double factor) {
  return load_below(glb, {{"scale", {factor, factor, factor}}});
}

TEST(CanonicalFrame, ScalingByAPowerOfTwoChangesNoBit) {
  for (const NamedScene& room : make_scenes()) {
    const Scene a = scaled(room.bytes, 1);
    for (double factor : {0x1p-20, 0.5, 2.0, 1024.0}) {
      const Scene b = scaled(room.bytes, factor);
      EXPECT_EQ(a.positions, b.positions) << room.file;
      EXPECT_EQ(a.frame.scale, b.frame.scale * factor) << room.file;
      EXPECT_EQ(a.frame.centre * factor, b.frame.centre) << room.file;
      EXPECT_EQ(a.camera("").position, b.camera("").position) << room.file;
    }
    EXPECT_NE(a.positions, scaled(room.bytes, 1.1).positions) << "twin";
  }
}

TEST(CanonicalFrame, NothingIsLostFarFromTheOrigin) {
  const std::string glb = make_scenes()[0].bytes;
  const Scene a = scaled(glb, 1), b = load_below(glb, {{"translation", {1e6, -3e6, 2e6}}});
  ASSERT_EQ(a.positions.size(), b.positions.size());
  for (size_t i = 0; i < a.positions.size(); ++i)
    EXPECT_LT(length(Vec3d(a.positions[i]) - Vec3d(b.positions[i])), 3e-7);
}

std::string fault_of_camera(const Scene& s, const std::string& name) {
  try {
    s.camera(name);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
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
  const Scene s = load(b);
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
  EXPECT_TRUE(fault_of_camera(s, "attic")
                  .ends_with("scene.glb:cameras: there is no camera \"attic\", expected one of "
                             "\"hall\", \"camera\", "
                             "\"hall.1\""));
}

TEST(Cameras, ASceneMayHaveNone) {
  GlbBuilder b = triangle();
  b.node({{"mesh", 0}});
  const Scene s = load(b);
  EXPECT_TRUE(s.cameras.empty());
  EXPECT_NE(fault_of_camera(s, "").find("the scene has no perspective camera"), std::string::npos);
}

}  // namespace tdpt::testing::reader_test
