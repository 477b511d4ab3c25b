// When compressed data are used, and which of them.
#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/scene/gltf/textures.h"
#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/squares.h"

namespace tdpt::testing::compression_test {

using Json = nlohmann::ordered_json;

Scene read(const GlbBuilder& b) {
  const TempFolder folder;
  return read_gltf(folder.write("scene.glb", b.glb()));
}

std::string refusal(const GlbBuilder& b) {
  try {
    read(b);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

Json& primitive(GlbBuilder& b) {
  return b.json["meshes"][0]["primitives"][0];
}
Json& extension(Json& primitive) {
  return primitive["extensions"]["KHR_draco_mesh_compression"];
}

/// Another square by Draco, its fourth vertex lower, in a bufferView of its own.
int lower_square(GlbBuilder& b) {
  std::string other = b.bin.substr(0, 76);
  other[76 - 5] = '\x3f', other[76 - 6] = '\0';  // y = 0.5
  return b.view(other);
}

double area_of(const Scene& s) {
  double area = 0;
  for (uint32_t t = 0; t < s.triangles.size(); ++t) area += shape_of(s, t).area;
  return area / (s.frame.scale * s.frame.scale);
}

TEST(Compression, ASquareIsASquare) {
  for (const GlbBuilder& b : {square_by_draco(), square_by_meshopt()}) {
    const Scene s = read(b);
    EXPECT_EQ(s.triangles.size(), 2u);
    EXPECT_NEAR(area_of(s), 1, 1e-6);
    EXPECT_EQ(s.warnings, std::vector<std::string>{});
    EXPECT_EQ(s.hash, content_hash(b.glb()));
  }
}

TEST(Compression, AMeshThatCannotBeDecodedIsNamed) {
  GlbBuilder b = square_by_draco();
  Json other = b.json["meshes"][0];
  const int broken = b.view("DRACO, or not");
  extension(other["primitives"][0])["bufferView"] = broken;
  b.json["meshes"].push_back(other);
  EXPECT_NE(refusal(b).find("meshes[1].primitives[0].extensions.KHR_draco_mesh_compression: cannot "
                            "be decoded"),
            std::string::npos);
}

TEST(Compression, AccessorsThatSeveralPrimitivesShareHaveTheDataOfEach) {
  GlbBuilder b = square_by_draco();
  Json other = primitive(b);
  extension(other)["bufferView"] = lower_square(b);
  b.json["meshes"][0]["primitives"].push_back(other);
  b.json["meshes"][0]["primitives"].push_back(primitive(b));
  EXPECT_NEAR(area_of(read(b)), 1 + 0.75 + 1, 1e-6);
}

TEST(Compression, ThePoseIsThatOfTheAnimationInBothKindsOfFile) {
  const auto mended = [](GlbBuilder b, bool moved) {
    b.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
    if (!moved) return b;
    const int output = b.floats({0, 0, 0, 1}, 4);
    const Json target = {{"node", 0}, {"path", "rotation"}};
    const Json sampler = {{"input", b.floats({0}, 1)}, {"output", output}};
    const Json channel = {{"sampler", 0}, {"target", target}};
    b.json["animations"] =
        Json::array({{{"channels", Json::array({channel})}, {"samplers", Json::array({sampler})}}});
    return b;
  };
  for (const GlbBuilder& b : {square_by_draco(), square_by_meshopt()}) {
    EXPECT_NEAR(area_of(read(mended(b, true))), 1, 1e-6);
    EXPECT_NE(refusal(mended(b, false)).find("nodes[0].rotation: is zero"), std::string::npos);
  }
}

TEST(Compression, AttributesThatAreNotReadAreNotAskedOfDraco) {
  GlbBuilder b = square_by_draco();
  primitive(b)["attributes"]["_X"] = 9;
  extension(primitive(b))["attributes"]["_X"] = 9;
  EXPECT_NEAR(area_of(read(b)), 1, 1e-6);
  primitive(b)["attributes"]["_X"] = 0;  // Draco holds no attribute 9
  EXPECT_NEAR(area_of(read(b)), 1, 1e-6);
}

// Encoders drop unused vertices and degenerate triangles, and not all update the counts.
TEST(Compression, DracoMayHoldLessThanAccessorsSay) {
  GlbBuilder b = square_by_draco();
  b.json["accessors"][0]["count"] = 9;
  b.json["accessors"][1]["count"] = 12;
  const Scene s = read(b);
  EXPECT_EQ(s.triangles.size(), 2u);
  EXPECT_EQ(s.positions.size(), 4u);
}

// Public samples do, and every viewer uses what Draco contains.
TEST(Compression, DracoMayHoldSomewhatMoreThanAccessorsSay) {
  for (const auto& [accessor, count] : {std::pair(0, 3), std::pair(1, 2)}) {
    GlbBuilder b = square_by_draco();
    b.json["accessors"][static_cast<size_t>(accessor)]["count"] = count;
    const Scene s = read(b);
    EXPECT_NEAR(area_of(s), 1, 1e-6);
  }
}

TEST(Compression, DracoHoldsTrianglesWhateverTheModeOfAPrimitive) {
  GlbBuilder b = square_by_draco();
  primitive(b)["mode"] = 5;
  b.json["accessors"][1]["count"] = 4;
  EXPECT_NEAR(area_of(read(b)), 1, 1e-6);
}

TEST(Compression, TheFallbackOfMeshoptimizerIsNotRead) {
  GlbBuilder b = square_by_meshopt();
  b.json["buffers"][0]["uri"] = "nowhere.bin";
  EXPECT_EQ(refusal(b), "");
}

TEST(Compression, TheFallbackOfMeshoptimizerNeedNotSayThatItIsOne) {
  GlbBuilder b = square_by_meshopt();
  b.json["buffers"][0].erase("extensions");
  EXPECT_EQ(refusal(b), "");
}

TEST(Compression, WhatIsDecodedIsHeldAgainstTheMemoryLimit) {
  GlbBuilder draco = square_by_draco(), meshopt = square_by_meshopt();
  draco.json["accessors"][0]["count"] = 4000;
  meshopt.bin = "\xa0" + std::string(512, '\0');  // 2560 vertices of zeros
  Json& view = meshopt.json["bufferViews"][0];
  view["byteLength"] = 30720;
  Json& e = view["extensions"]["EXT_meshopt_compression"];
  e["byteLength"] = meshopt.bin.size(), e["count"] = 2560;
  const uint64_t machine = memory_limit();
  limit_memory(30000);
  const std::string of_draco = refusal(draco), of_meshopt = refusal(meshopt);
  limit_memory(machine);
  const std::string most = " of memory, expected at most the 29.3 KiB of --max-memory";
  EXPECT_TRUE(of_draco.ends_with(
      "KHR_draco_mesh_compression: 4000 vertices and 6 corners of triangles, with those before, "
      "take 46.9 KiB" +
      most))
      << of_draco;
  EXPECT_TRUE(
      of_meshopt.ends_with("EXT_meshopt_compression: 2560 elements of 12 bytes, with those "
                           "before, take 30 KiB" +
                           most))
      << of_meshopt;
}

TEST(Compression, AWebPIsNotBelievedMoreThanItsBytes) {
  const auto lossless = [](uint32_t width, uint32_t height) {
    std::string image = texels_by_webp();
    const uint32_t size = (width - 1) | (height - 1) << 14 | 1u << 28;
    for (size_t k = 0; k < 4; ++k) image[21 + k] = static_cast<char>(size >> (8 * k));
    return image;
  };
  EXPECT_EQ(gltf::texels_declared(lossless(2, 2)), 4);
  EXPECT_EQ(gltf::texels_declared(lossless(4096, 4096)), 1 << 24);
  EXPECT_EQ(gltf::texels_declared(lossless(4097, 4096)), std::nullopt);
}

}  // namespace tdpt::testing::compression_test
