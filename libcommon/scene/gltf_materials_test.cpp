// Emission, albedo, and the sentences that say what was approximated.
#include <gtest/gtest.h>

#include "libcommon/scene/scene.h"
#include "libcommon/testing/glb_builder.h"
#include "libcommon/testing/temp_folder.h"

namespace tdpt::testing {
namespace {

using Json = nlohmann::ordered_json;
using Sentences = std::vector<std::string>;

const Json kLambert = {{"KHR_materials_specular", {{"specularFactor", 0}}}};

/// One triangle for each material.
Scene scene_with(const std::vector<Json>& materials, const Json& more = Json::object()) {
  GlbBuilder b;
  const int p = b.floats({0, 0, 0, 2, 0, 0, 0, 1, 0}, 3);
  for (const Json& m : materials) {
    const int index = b.material(m);
    b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}, {"material", index}})}});
  }
  b.json.update(more);
  const TempFolder folder;
  return read_gltf(folder.write("scene.glb", b.glb()));
}

Json lambert(double r, double g, double blue) {
  return {{"pbrMetallicRoughness",
           {{"baseColorFactor", {r, g, blue, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}}},
          {"extensions", kLambert}};
}

TEST(Materials, ALambertianOneNeedsNoWarning) {
  const Scene s = scene_with({lambert(0.1, 0.2, 0.3)});
  EXPECT_EQ(s.materials[0].base_color, Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(s.materials[0].emission, Rgb());
  EXPECT_FALSE(s.materials[0].double_sided);
  EXPECT_EQ(s.warnings, Sentences{});
}

TEST(Materials, RadianceIsFactorTimesStrength) {
  Json m = lambert(0, 0, 0);
  m["emissiveFactor"] = {1, 0.5, 0.25};
  m["doubleSided"] = true;
  EXPECT_EQ(scene_with({m}).materials[0].emission, Rgb(1, 0.5f, 0.25f));
  m["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 100;
  const Scene s = scene_with({m});
  EXPECT_EQ(s.materials[0].emission, Rgb(100, 50, 25));
  EXPECT_TRUE(s.materials[0].double_sided);
}

TEST(Materials, OneSentenceForEachKindOfApproximation) {
  Json metal = lambert(0.9, 0.9, 0.9), glass = metal, plastic = metal, coat = metal, flat = metal,
       alpha = metal, bright = lambert(1.5, 0.2, 0.2);
  metal["pbrMetallicRoughness"]["metallicFactor"] = 1;
  glass["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 1;
  plastic["extensions"].erase("KHR_materials_specular");
  coat["extensions"]["KHR_materials_clearcoat"] = Json::object();
  flat["extensions"]["KHR_materials_unlit"] = Json::object();
  alpha["alphaMode"] = "MASK";
  const Scene s = scene_with({metal, metal, glass, plastic, coat, flat, alpha, bright});
  EXPECT_EQ(
      s.warnings,
      (Sentences{"2 materials are metallic: taken as diffuse with the base colour",
                 "1 material transmits light: taken as opaque, diffuse with the base colour",
                 "1 material has a specular reflection, which is left out",
                 "1 material has a coat, sheen or the like, which is left out",
                 "1 material is unlit: taken as diffuse with the base colour",
                 "1 material is not opaque (alphaMode): taken as opaque",
                 "1 material reflects more than all light: the base colour is clamped to 1"}));
  EXPECT_EQ(s.materials[7].base_color, Rgb(1, 0.2f, 0.2f));
  EXPECT_EQ(s.materials[0].base_color, Rgb(0.9f));
}

// 2 x 1 texels, white and black, as PPM: the smallest format that the decoder knows.
const std::string kImage = std::string("P6 2 1 255\n\377\377\377\0\0\0", 17);

Json with_image(const Json& image) {
  return {{"textures", Json::array({{{"source", 0}}})}, {"images", Json::array({image})}};
}

TEST(Textures, TheirAverageColourIsTakenInLinearLight) {
  Json m = lambert(0.5, 1, 0);
  m["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  const Scene s = scene_with(
      {m}, with_image({{"uri", "data:image/x-portable-pixmap;base64," + base64(kImage)}}));
  EXPECT_EQ(s.materials[0].base_color, Rgb(0.25f, 0.5f, 0));
  EXPECT_EQ(s.warnings,
            Sentences{"1 material has a base-colour texture: its average colour is used"});
}

TEST(Textures, EmissiveOnesToo) {
  Json m = lambert(0, 0, 0);
  m["emissiveFactor"] = {4, 4, 4};
  m["emissiveTexture"] = {{"index", 0}};
  const Scene s = scene_with(
      {m}, with_image({{"uri", "data:image/x-portable-pixmap;base64," + base64(kImage)}}));
  EXPECT_EQ(s.materials[0].emission, Rgb(2));
  EXPECT_EQ(s.warnings,
            Sentences{"1 material has an emissive texture: its average colour is used"});
}

TEST(Textures, OnesThatCannotBeDecodedLeaveTheFactor) {
  Json m = lambert(0.5, 1, 0);
  m["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  const Scene s = scene_with({m}, with_image({{"uri", "data:image/webp;base64,AAAA"}}));
  EXPECT_EQ(s.materials[0].base_color, Rgb(0.5f, 1, 0));
  EXPECT_EQ(
      s.warnings,
      Sentences{
          "1 material has a texture that cannot be decoded: the colour factor alone is used"});
}

TEST(Materials, SurfacesWithoutOneAreGrey) {
  GlbBuilder b;
  const int p = b.floats({0, 0, 0, 2, 0, 0, 0, 1, 0}, 3);
  const Json at = {{"POSITION", p}, {"COLOR_0", p}};
  b.node({{"mesh", b.mesh({{"attributes", at}})},
          {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const TempFolder folder;
  const Scene s = read_gltf(folder.write("scene.glb", b.glb()));
  EXPECT_EQ(s.material_of(0).base_color, Rgb(0.8f));
  EXPECT_EQ(s.warnings, (Sentences{"surfaces without a material are taken as diffuse grey of 0.8",
                                   "1 punctual light is left out",
                                   "1 primitive has vertex colours, which are left out"}));
}

}  // namespace
}  // namespace tdpt::testing
