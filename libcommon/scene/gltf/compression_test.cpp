// When compressed data are used, and which of them.
#include <gtest/gtest.h>
#include <cmath>

#include "libcommon/base/file.h"
#include "libcommon/base/provenance.h"
#include "libcommon/scene/gltf/textures.h"
#include "libcommon/scene/texture.h"
#include "libcommon/testing/rooms/squares.h"
#include "libcommon/testing/scenes/materials.h"

namespace tdpt::testing::compression_test {

Json& primitive(GlbBuilder& b) {
  return b.json["meshes"][0]["primitives"][0];
}
Json& extension(Json& primitive) {
  return primitive["extensions"]["KHR_draco_mesh_compression"];
}

double area_of(const Scene& s) {
  double area = 0;
  for (uint32_t t = 0; t < s.triangles.size(); ++t) area += shape_of(s, t).area;
  return area / (s.frame.scale * s.frame.scale);
}
double area_of(const GlbBuilder& b) {
  return area_of(load(b));
}

GlbBuilder square_by_khr_meshopt() {
  GlbBuilder b = square_by_meshopt();
  std::string text = b.json.dump();
  for (size_t at; (at = text.find("EXT_meshopt")) != text.npos;) text.replace(at, 3, "KHR");
  b.json = Json::parse(text);
  return b;
}

TEST(Compression, ASquareIsASquare) {
  for (const GlbBuilder& b : {square_by_draco(), square_by_meshopt(), square_by_khr_meshopt()}) {
    const Scene s = load(b);
    EXPECT_EQ(s.positions, load(square()).positions);
    EXPECT_EQ(s.triangles.size(), 2u);
    EXPECT_NEAR(area_of(s), 1, 1e-6);
    EXPECT_EQ(s.warnings, Sentences{});
    EXPECT_EQ(s.hash, content_hash(b.glb()));
  }
}

/// How far a scene is from another: for each of its triangles, the nearest of the other's,
/// whichever its first corner.
struct Difference {
  double metres = 0;  ///< of corners
  double colour = 0;  ///< at three places of the triangle
  double normal = 0;  ///< of shading normals
};
Difference difference(const Scene& a, const Scene& b) {
  Difference all;
  for (uint32_t t = 0; t < a.triangles.size(); ++t) {
    Difference nearest{INFINITY, 0, 0};
    for (uint32_t u = 0; u < b.triangles.size(); ++u)
      for (int turn = 0; turn < 3; ++turn) {
        Difference d;
        for (int c = 0; c < 3; ++c) {
          // Corner c of t is corner k of u; one place near each corner.
          const int k = (c + turn) % 3;
          d.metres = std::max(d.metres, length(a.frame.to_metres(Vec3d(a.vertex(t, c))) -
                                               b.frame.to_metres(Vec3d(b.vertex(u, k)))));
          const auto place = [](uint32_t triangle, int corner) {
            return SurfacePlace{triangle, corner == 1 ? 0.8 : 0.1, corner == 2 ? 0.8 : 0.1};
          };
          const auto here = base_color_at(a, place(t, c)), there = base_color_at(b, place(u, k));
          for (size_t i = 0; i < 3; ++i)
            d.colour = std::max(d.colour, std::abs(double{here[i]} - there[i]));
          d.normal =
              std::max(d.normal, length(shading_normal_at(a, place(t, c), shape_of(a, t).normal) -
                                        shading_normal_at(b, place(u, k), shape_of(b, u).normal)));
        }
        if (d.metres < nearest.metres) nearest = d;
      }
    all = {std::max(all.metres, nearest.metres), std::max(all.colour, nearest.colour),
           std::max(all.normal, nearest.normal)};
  }
  return all;
}

// One room of ours as other programs compress it, some of them with losses.
TEST(Compression, FilesOfOtherProgramsAreTheRoom) {
  const std::string folder = TDPT_TESTDATA;
  const Scene plain = read_gltf(folder + "/encodings/plain.glb");
  struct Case {
    const char* file;
    double metres, colour;
  };
  for (const Case& c : {Case{"draco-gltf-pipeline", 1e-3, 1e-2},
                        {"draco-gltf-transform", 1e-3, 1e-2},
                        {"meshopt-gltf-transform", 1e-3, 1e-2},
                        {"meshopt-gltfpack", 1e-3, 1e-2},
                        {"webp-lossless", 0, 0},
                        {"webp-lossy", 0, 0.3}}) {
    const Scene s = read_gltf(folder + "/compressed/" + c.file + ".glb");
    EXPECT_EQ(s.warnings, Sentences{}) << c.file;
    EXPECT_EQ(s.triangles.size(), plain.triangles.size()) << c.file;
    for (const Difference& d : {difference(s, plain), difference(plain, s)}) {
      EXPECT_LE(d.metres, c.metres) << c.file;
      EXPECT_LE(d.colour, c.colour) << c.file;
      EXPECT_LE(d.normal, 1e-2) << c.file;
    }
  }
  Scene other = plain;  // twins
  other.positions[3].x += 0.01f;
  EXPECT_GT(difference(plain, other).metres, 2e-3);
  other = plain;
  std::swap(other.triangles[4].vertex[0], other.triangles[4].vertex[1]);
  EXPECT_GT(difference(plain, other).metres, 2e-3);
  other = plain;
  for (auto& uv : other.uv[0]) std::swap(uv[0], uv[1]);
  EXPECT_GT(difference(plain, other).colour, 0.3);
}

TEST(Compression, AccessorsThatSeveralPrimitivesShareHaveTheDataOfEach) {
  GlbBuilder b = square_by_draco();
  std::string lower = b.bin.substr(0, 76);
  lower[76 - 5] = '\x3f', lower[76 - 6] = '\0';  // y of the fourth vertex: 0.5
  Json other = primitive(b);
  extension(other)["bufferView"] = b.view(lower);
  b.json["meshes"][0]["primitives"].push_back(other);
  b.json["meshes"][0]["primitives"].push_back(primitive(b));
  EXPECT_NEAR(area_of(b), 1 + 0.75 + 1, 1e-6);
}

// Encoders drop unused vertices and degenerate triangles, and not all update the counts; viewers
// use what Draco contains, triangles whatever the mode.
TEST(Compression, DracoHoldsWhatItHolds) {
  for (const auto& [vertices, corners, mode] :
       std::vector<std::array<int, 3>>{{9, 12, 4}, {3, 6, 4}, {4, 2, 4}, {4, 4, 5}}) {
    GlbBuilder b = square_by_draco();
    b.json["accessors"][0]["count"] = vertices;
    b.json["accessors"][1]["count"] = corners;
    primitive(b)["mode"] = mode;
    EXPECT_EQ(load(b).positions.size(), 4u);
    EXPECT_NEAR(area_of(b), 1, 1e-6) << vertices << ' ' << corners;
  }
  GlbBuilder b = square_by_draco();  // attributes that are not read are not asked of it
  extension(primitive(b))["attributes"]["_X"] = 9;
  for (const int accessor : {9, 0}) {
    primitive(b)["attributes"]["_X"] = accessor;
    EXPECT_NEAR(area_of(b), 1, 1e-6);
  }
}

TEST(Compression, TheFallbackOfMeshoptimizerIsNotRead) {
  GlbBuilder b = square_by_meshopt();
  b.json["buffers"][0]["uri"] = "nowhere.bin";
  EXPECT_EQ(refusal(b), "");
  b.json["buffers"][0] = {{"byteLength", 60}};  // nor need it say that it is one
  EXPECT_EQ(refusal(b), "");
  b.json["bufferViews"][0].erase("extensions");
  EXPECT_NE(refusal(b).find("buffers[1]: has neither a uri nor a binary chunk"), std::string::npos);
}

TEST(Compression, WhatIsDecodedIsHeldAgainstTheMemoryLimit) {
  GlbBuilder draco = square_by_draco(), meshopt = square_by_meshopt();
  draco.json["accessors"][0]["count"] = 4000;
  meshopt.bin = "\xa0" + std::string(512, '\0');  // 2560 vertices of zeros
  Json& view = meshopt.json["bufferViews"][0];
  view["byteLength"] = 30720;
  view["extensions"]["EXT_meshopt_compression"].update({{"byteLength", 513}, {"count", 2560}});
  const uint64_t machine = memory_limit();
  limit_memory(30000);
  const std::string of_draco = refusal(draco), of_meshopt = refusal(meshopt);
  limit_memory(machine);
  const std::string most = " of memory, expected at most the 29.3 KiB of --max-memory";
  EXPECT_TRUE(of_draco.ends_with("with those before, take 46.9 KiB" + most)) << of_draco;
  EXPECT_TRUE(of_meshopt.ends_with("with those before, take 30 KiB" + most)) << of_meshopt;
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
