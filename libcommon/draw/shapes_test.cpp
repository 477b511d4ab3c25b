#include "libcommon/draw/shapes.h"

#include <cstring>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::draw::shapes_test {

using Kind = Shape::Kind;

uint32_t word(const std::string& bytes, size_t at) {
  uint32_t v;
  std::memcpy(&v, bytes.data() + at, sizeof v);
  return v;
}
nlohmann::json json_of(const std::string& glb) {
  return nlohmann::json::parse(glb.substr(20, word(glb, 12)));
}

std::vector<Shape> three_meshes() {
  Shape square{.name = "square"}, line{.name = "line", .kind = Kind::lines},
      point{.name = "point", .kind = Kind::points};
  square.square({1000.25, 2, 3}, {0, 0, 1}, 0.5, ink(0xff8000));
  line.line({0, 0, 0}, {1, 2, 3}, ink(0xff0000), ink(0x0000ff));
  point.point({4, 5, 6}, {ink(0x0a141e), 0.4f});
  return {square, Shape{.name = "empty"}, line, point};
}

TEST(debug_glb, has_a_mesh_for_each_shape_that_is_not_empty) {
  Provenance provenance;
  provenance.made_by("mincut", "mincut");
  const nlohmann::json j = json_of(debug_glb_bytes(three_meshes(), provenance));
  EXPECT_EQ(j["asset"]["extras"]["provenance"].size(), 1u);
  EXPECT_EQ(j["extensionsUsed"], nlohmann::json({"KHR_materials_unlit"}));
  ASSERT_EQ(j["meshes"].size(), 3u);
  const int modes[] = {4, 1, 0}, counts[] = {6, 2, 1};
  for (size_t m = 0; m < 3; ++m) {
    const nlohmann::json& p = j["meshes"][m]["primitives"][0];
    EXPECT_EQ(p["mode"], modes[m]);
    for (const char* attribute : {"POSITION", "COLOR_0"})
      EXPECT_EQ(j["accessors"][p["attributes"][attribute].get<size_t>()]["count"], counts[m]);
  }
  EXPECT_FALSE(j["materials"][0].contains("alphaMode"));
  EXPECT_EQ(j["materials"][2]["alphaMode"], "BLEND");
}

TEST(debug_glb, without_meshes_is_still_a_file) {
  const nlohmann::json j = json_of(debug_glb_bytes({Shape{}}, {}));
  for (const char* absent : {"meshes", "buffers", "nodes", "materials", "extensionsUsed"})
    EXPECT_FALSE(j.contains(absent)) << absent;
}

TEST(debug_glb, our_own_reader_finds_the_triangles_in_place) {
  const testing::TempFolder folder;
  const Scene scene = read_gltf(folder.write("a.glb", debug_glb_bytes(three_meshes(), {})));
  ASSERT_EQ(scene.triangles.size(), 2u);
  for (uint32_t t = 0; t < 2; ++t) {
    EXPECT_NEAR(shape_of(scene, t).normal.z, 1, 1e-6);
    for (int k = 0; k < 3; ++k) {
      const Vec3d p = scene.frame.to_metres(Vec3d(scene.vertex(t, k)));
      EXPECT_NEAR(std::abs(p.x - 1000.25), 0.25, 1e-6);
      EXPECT_NEAR(std::abs(p.y - 2), 0.25, 1e-6);
      EXPECT_NEAR(p.z, 3, 1e-6);
    }
  }
}

TEST(debug_glb, colours_are_linear) {
  const std::string glb = debug_glb_bytes(three_meshes(), {});
  const nlohmann::json j = json_of(glb);
  const auto accessor = j["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"].get<size_t>();
  const auto view = j["accessors"][accessor]["bufferView"].get<size_t>();
  const size_t at = 20 + word(glb, 12) + 8 + j["bufferViews"][view]["byteOffset"].get<size_t>();
  const auto byte = [&](size_t k) { return static_cast<uint8_t>(glb[at + k]); };
  EXPECT_EQ(byte(0), 255);
  EXPECT_EQ(byte(1), 55) << "sRGB 128 is a linear 0.216";
  EXPECT_EQ(byte(2), 0);
  EXPECT_EQ(byte(3), 255);
}

TEST(debug_glb, cubes_face_outwards) {
  Shape cube;
  cube.cube({1, 2, 3}, 2, ink(0));
  ASSERT_EQ(cube.positions.size(), 36u);
  for (size_t i = 0; i < 36; i += 3) {
    const Vec3d &a = cube.positions[i], &b = cube.positions[i + 1], &c = cube.positions[i + 2];
    const Vec3d n = cross(b - a, c - a);
    EXPECT_NEAR(dot(normalize(n), a - Vec3d{1, 2, 3}), 1, 1e-12);
  }
}

}  // namespace tdpt::draw::shapes_test
