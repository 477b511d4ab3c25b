// Deviations that every viewer accepts: the scene equals that of the correct file, and what is left
// out is told. Twins: the same error is fatal where it matters (malformed_test.cpp).
#include <gtest/gtest.h>
#include <functional>

#include "libcommon/testing/rooms/squares.h"
#include "libcommon/testing/scenes/materials.h"

namespace tdpt::testing::leniency_test {

/// Expects `bytes` to be the square; returns the warnings.
Sentences told_of_square(const std::string& bytes) {
  const TempFolder folder;
  const Scene scene = read_gltf(folder.write("scene.glb", bytes)), right = load(square());
  EXPECT_EQ(scene.positions, right.positions);
  EXPECT_EQ(scene.triangles.size(), right.triangles.size());
  EXPECT_EQ(scene.cameras.size(), right.cameras.size());
  EXPECT_EQ(right.warnings, Sentences{});
  return scene.warnings;
}
Sentences told(const std::function<void(GlbBuilder&)>& spoil) {
  GlbBuilder b = square();
  spoil(b);
  return told_of_square(b.glb());
}

void set_u32(std::string& bytes, size_t at, size_t value) {
  for (size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>((value >> (8 * i)) & 255);
}

TEST(Leniency, ContainersThatAreNotQuiteThose) {
  const std::string whole = square().glb();
  EXPECT_EQ(told_of_square(whole + "more"), Sentences{});
  std::string behind = whole + std::string("\xff\xff\0\0", 4);  // no chunk at all
  set_u32(behind, 8, behind.size());
  EXPECT_EQ(told_of_square(behind), Sentences{});

  const std::string bin = square().bin, json = square().document().dump();
  const std::string zeros(4 + (4 - json.size() % 4) % 4, '\0');
  EXPECT_EQ(told_of_square(glb_of(json + zeros, bin)), Sentences{}) << "JSON filled up by zeros";

  std::string out("glTF\2\0\0\0\0\0\0\0", 12);  // chunks that are not filled up
  const auto chunk = [&](const std::string& content, const char* type) {
    out += std::string(4, '\0') + std::string(type, 4) + content;
    set_u32(out, out.size() - content.size() - 8, content.size());
  };
  chunk(json + std::string(1 + (4 - json.size() % 4), ' '), "JSON");
  chunk(bin, "BIN");
  set_u32(out, 8, out.size());
  EXPECT_EQ(told_of_square(out), Sentences{});
}

TEST(Leniency, RootsThatAreChildren) {
  GlbBuilder b = square();  // the camera's node is a root and holds the square's
  b.json["nodes"][1]["children"] = {0};
  const Scene scene = load(b);
  b.json["scenes"][0]["nodes"] = {1};
  EXPECT_EQ(scene.positions, load(b).positions);
  EXPECT_EQ(scene.triangles.size(), 2u);
  EXPECT_EQ(told([](GlbBuilder& c) { c.json["scenes"][0]["nodes"] = {0, 0, 1}; }), Sentences{});
}

TEST(Leniency, CamerasAndLampsWithoutDirection) {
  const Sentences sentences = told([](GlbBuilder& b) {
    b.camera("flat", {0.5, 0.5, 2}, {0.5, 0.5, 0}, 1, 1);
    b.json["nodes"][2]["scale"] = {0, 0, 0};
    b.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({{{"type", "spot"}}});
    b.node({{"scale", {1, 1, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  });
  EXPECT_EQ(sentences, (Sentences{"cameras with a flat transform are left out: nodes[2]",
                                  "lights with a flat transform are left out: nodes[3]"}));
}

TEST(Leniency, PrimitivesThatAreNoTriangles) {
  const auto with = [](const Json& primitive) {
    return told([&](GlbBuilder& b) {
      b.indices_u16({0, 1});
      // The format says that an accessor without a bufferView holds zeros.
      b.json["accessors"].push_back({{"componentType", 5123}, {"count", 3}, {"type", "SCALAR"}});
      b.json["meshes"][0]["primitives"].push_back(primitive);
    });
  };
  const Json positions = {{"POSITION", 0}};
  const std::string place = "meshes[0].primitives[1]",
                    corners = "corners that make no triangle are left out: " + place;
  EXPECT_EQ(with({{"attributes", positions}, {"mode", 1}}), Sentences{}) << "lines";
  EXPECT_EQ(with({{"attributes", Json::object()}}),
            Sentences{"primitives without POSITION are left out: " + place});
  EXPECT_EQ(with({{"attributes", positions}, {"material", 0}, {"indices", 2}}), Sentences{corners});
  EXPECT_EQ(with({{"attributes", positions}, {"material", 0}, {"indices", 2}, {"mode", 5}}),
            Sentences{corners});
  EXPECT_EQ(with({{"attributes", positions}, {"material", 0}, {"indices", 3}}),
            Sentences{"1 triangle without area: left out"});
}

TEST(Leniency, WhatIsNotReadMayBeAnything) {
  EXPECT_EQ(told([](GlbBuilder& b) {
              Json& primitive = b.json["meshes"][0]["primitives"][0];
              primitive["attributes"]["_X"] = 9;
              primitive["attributes"]["TEXCOORD_7"] = "x";
              primitive["targets"] = {{{"_X", 9}}};
              b.json["extensionsUsed"] = {"KHR_lights_environment"};
            }),
            Sentences{});
  GlbBuilder b = square();
  b.json["extensionsRequired"] = {"KHR_lights_environment"};
  EXPECT_NE(refusal(b).find("\"KHR_lights_environment\" is not supported"), std::string::npos);
}

}  // namespace tdpt::testing::leniency_test
