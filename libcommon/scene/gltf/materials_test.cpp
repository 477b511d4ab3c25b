// How materials are converted, and the warnings and needs that they cause.
#include <gtest/gtest.h>

#include "libcommon/testing/scenes/materials.h"
#include "libcommon/testing/scenes/needs.h"

namespace tdpt::testing::materials_test {

TEST(Materials, ALambertianOneIsPlain) {
  const Scene s = scene_with({lambert(0.1, 0.2, 0.3)});
  const Material& m = s.materials[0];
  EXPECT_EQ(m.base_color, Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.emission, Rgb());
  EXPECT_FALSE(m.double_sided);
  EXPECT_TRUE(m.plain);
  EXPECT_EQ(s.warnings, Sentences{});
  EXPECT_EQ(needs_of(s), Sentences{});
  EXPECT_TRUE(s.normals.empty() && s.tangents.empty() && s.colours.empty() && s.smooth.empty());
  EXPECT_TRUE(s.uv[0].empty() && s.uv[1].empty() && s.images.empty());
}

TEST(Materials, TheDefaultsOfTheFormat) {
  const Scene s = scene_with({Json::object()});
  const Material& m = s.materials[0];
  EXPECT_EQ(m.base_color, Rgb(1));
  EXPECT_EQ(m.metallic, 1);
  EXPECT_EQ(m.roughness, 1);
  EXPECT_EQ(m.specular, 1);
  EXPECT_EQ(m.specular_color, Rgb(1));
  EXPECT_EQ(m.ior, 1.5f);
  EXPECT_EQ(m.transmission, 0);
  EXPECT_EQ(m.alpha_mode, Material::Alpha::opaque);
  EXPECT_FALSE(m.plain);
  EXPECT_EQ(needs_of(s), Sentences{"specular"});
}

TEST(Materials, ARoughDielectricIsNotPlain) {
  Json m = lambert(0.5, 0.5, 0.5);
  m.erase("extensions");
  EXPECT_FALSE(material(m).plain);
  m["extensions"]["KHR_materials_ior"]["ior"] = 1;  // no interface, no reflection
  EXPECT_TRUE(material(m).plain);
  EXPECT_EQ(material(m).specular, 0);
  m["extensions"]["KHR_materials_ior"]["ior"] = 0;  // means infinity
  EXPECT_EQ(material(m).ior, 1e6f);
}

TEST(Materials, RadianceIsFactorTimesStrength) {
  Json m = lambert(0, 0, 0);
  m["emissiveFactor"] = {1, 0.5, 0.25};
  m["doubleSided"] = true;
  EXPECT_EQ(material(m).emission, Rgb(1, 0.5f, 0.25f));
  m["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 100;
  const Scene s = scene_with({m});
  EXPECT_EQ(s.materials[0].emission, Rgb(100, 50, 25));
  EXPECT_TRUE(s.materials[0].double_sided);
  EXPECT_TRUE(s.materials[0].plain);
  EXPECT_EQ(needs_of(s), Sentences{});
}

TEST(Materials, ARadianceBelow1e_30CountsAsNone) {
  Json m = lambert(0, 0, 0);
  m["emissiveFactor"] = {1, 0.5, 0.25};
  Json& strength = m["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"];
  strength = 1e-30;
  EXPECT_EQ(scene_with({m}).warnings, Sentences{});
  EXPECT_EQ(material(m).emission.x, 1e-30f);
  strength = 0.9e-30;
  const Scene s = scene_with({m, m});
  EXPECT_EQ(s.materials[0].emission, Rgb());
  EXPECT_EQ(s.warnings,
            Sentences{"a radiance below 1e-30 counts as none: materials[0], materials[1]"});
}

TEST(Materials, LobesAndVolume) {
  Json m = lambert(0.9, 0.8, 0.7);
  m["pbrMetallicRoughness"]["metallicFactor"] = 0.25;
  m["pbrMetallicRoughness"]["roughnessFactor"] = 0.5;
  m["extensions"] = {
      {"KHR_materials_specular", {{"specularFactor", 0.75}, {"specularColorFactor", {1, 0.5, 2}}}},
      {"KHR_materials_ior", {{"ior", 1.33}}},
      {"KHR_materials_transmission", {{"transmissionFactor", 0.5}}},
      {"KHR_materials_volume",
       {{"thicknessFactor", 1},
        {"attenuationDistance", 0.5},
        {"attenuationColor", {1, std::exp(-1.0), 0}}}},
      {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.75}, {"clearcoatRoughnessFactor", 0.25}}},
      {"KHR_materials_sheen",
       {{"sheenColorFactor", {0.5, 0.25, 2}}, {"sheenRoughnessFactor", 0.5}}}};
  const Scene s = scene_with({m});
  const Material& out = s.materials[0];
  EXPECT_EQ(out.metallic, 0.25f);
  EXPECT_EQ(out.roughness, 0.5f);
  EXPECT_EQ(out.specular, 0.75f);
  EXPECT_EQ(out.specular_color, Rgb(1, 0.5f, 2));
  EXPECT_EQ(out.ior, 1.33f);
  EXPECT_EQ(out.transmission, 0.5f);
  EXPECT_TRUE(out.solid);
  EXPECT_EQ(out.absorption.x, 0);
  EXPECT_NEAR(out.absorption.y, 2 / s.frame.scale, 1e-6);  // 1 after half a metre
  EXPECT_EQ(out.absorption.z, 1e30f);                      // nothing is left of black
  EXPECT_EQ(out.coat, 0.75f);
  EXPECT_EQ(out.coat_roughness, 0.25f);
  EXPECT_EQ(out.sheen_color, Rgb(0.5f, 0.25f, 1));
  EXPECT_EQ(out.sheen_roughness, 0.5f);
  EXPECT_FALSE(out.plain);
  EXPECT_EQ(needs_of(s),
            (Sentences{"specular", "transmission", "clear coat", "sheen", "absorption"}));
  EXPECT_EQ(s.warnings, Sentences{});
}

TEST(Materials, AbsorptionIsPerCanonicalLength) {
  Json m = lambert(1, 1, 1);
  m["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 1;
  m["extensions"]["KHR_materials_volume"] = {
      {"thicknessFactor", 1}, {"attenuationDistance", 3}, {"attenuationColor", {0.5, 0.5, 0.5}}};
  for (double size : {1.0, 16.0}) {
    GlbBuilder b;
    const int p = b.floats({0, 0, 0, 2, 0, 0, 0, 1, 0}, 3);
    const int index = b.material(m);
    b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}, {"material", index}})},
            {"scale", {size, size, size}}});
    const Scene s = load(b);
    EXPECT_EQ(s.frame.scale, 1 / size);
    // exp(-absorption * 3 m) is the colour.
    EXPECT_NEAR(std::exp(-s.materials[0].absorption.x * 3 * s.frame.scale), 0.5, 1e-6);
  }
}

TEST(Materials, AThinSheetAbsorbsNothing) {
  Json m = lambert(1, 1, 1);
  m["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 1;
  m["extensions"]["KHR_materials_volume"] = {{"attenuationDistance", 3},
                                             {"attenuationColor", {0.5, 0.5, 0.5}}};
  EXPECT_FALSE(material(m).solid);
  EXPECT_EQ(material(m).absorption, Rgb());
  m["extensions"]["KHR_materials_volume"]["thicknessFactor"] = 1;
  m["extensions"]["KHR_materials_volume"].erase("attenuationDistance");
  EXPECT_TRUE(material(m).solid);
  EXPECT_EQ(material(m).absorption, Rgb());
}

TEST(Materials, AMetalNeitherTransmitsNorKeepsDielectricMaps) {
  Json m = lambert(0.9, 0.9, 0.9);
  m["pbrMetallicRoughness"]["metallicFactor"] = 1;
  m["extensions"]["KHR_materials_transmission"]["transmissionFactor"] = 1;
  m["extensions"]["KHR_materials_specular"] = {{"specularTexture", {{"index", 0}}}};
  const Scene s = scene_with({m}, with(kTwo));
  EXPECT_EQ(s.materials[0].transmission, 0);
  EXPECT_TRUE(s.images.empty());
  EXPECT_EQ(needs_of(s), Sentences{"specular"});
}

TEST(Materials, AnUnlitOneEmitsItsBaseColour) {
  Json m = lambert(0.5, 1, 0.25);
  m["extensions"]["KHR_materials_unlit"] = Json::object();
  m["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  m["emissiveFactor"] = {7, 7, 7};
  const Scene s = scene_with({m}, with(kTwo));
  EXPECT_EQ(s.materials[0].base_color, Rgb());
  EXPECT_EQ(s.materials[0].emission, Rgb(0.5f, 1, 0.25f));
  EXPECT_TRUE(s.materials[0].maps[MAP_EMISSION] && s.materials[0].maps[MAP_EMISSION].srgb);
  EXPECT_FALSE(s.materials[0].maps[MAP_BASE]);
  EXPECT_FALSE(s.materials[0].double_sided);
  EXPECT_EQ(needs_of(s), (Sentences{"textures", "textured emission"}));
  EXPECT_EQ(
      s.warnings,
      Sentences{"unlit materials are taken as black, emitting the base colour: materials[0]"});
  m["alphaMode"] = "BLEND";  // the same texture cuts holes
  EXPECT_TRUE(material(m, with(kTwo)).maps[MAP_BASE]);
}

TEST(Materials, ConductorsHaveTheColourOfTheirIndex) {
  Json m = lambert(0.5, 0.5, 0.5);
  m["pbrMetallicRoughness"]["roughnessFactor"] = 0.25;
  m["extras"] = {{"tdpt_eta", {0.143, 0.375, 4.37}}, {"tdpt_k", {3.983, 2.386, 3.5}}};
  const Scene s = scene_with({m});
  const Material& out = s.materials[0];
  EXPECT_EQ(out.metallic, 1);
  EXPECT_EQ(out.roughness, 0.25f);
  EXPECT_NEAR(out.base_color.x, 0.967, 0.001);  // ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2)
  EXPECT_NEAR(out.base_color.z, 0.575, 0.001);
  EXPECT_LT(out.dip.x, 0.5f);
  EXPECT_GT(out.dip.z, 4);
  EXPECT_EQ(needs_of(s), Sentences{"specular"});
  m["extras"] = {{"artist", "nobody"}};
  EXPECT_TRUE(scene_with({m}).materials[0].dip == Rgb());
}

TEST(Materials, WhatIsNotThereIsNotReadNorLeftOut) {
  Json m = lambert(0.5, 0.5, 0.5);
  for (const char* layer :
       {"iridescence", "anisotropy", "dispersion", "diffuse_transmission", "volume_scatter"})
    m["extensions"][std::string("KHR_materials_") + layer] = Json::object();
  m["extensions"]["KHR_xmp_json_ld"] = Json::object();
  m["extensions"]["KHR_materials_clearcoat"] = {{"clearcoatRoughnessFactor", 0.25},
                                                {"clearcoatNormalTexture", {{"index", 0}}}};
  m["extensions"]["KHR_materials_sheen"] = {{"sheenRoughnessFactor", 0.5},
                                            {"sheenColorTexture", {{"index", 0}}}};
  const Scene s = scene_with({m}, with(kTwo));
  EXPECT_TRUE(s.materials[0].plain);
  EXPECT_TRUE(s.images.empty());
  EXPECT_EQ(s.warnings, Sentences{});
}

TEST(Materials, WhatIsLeftOutIsNamedWithTheMaterial) {
  const auto named = [](const char* name, Json extensions) {
    Json m = lambert(0.9, 0.9, 0.9);
    if (*name) m["name"] = name;
    m["extensions"].update(extensions);
    return m;
  };
  const Json soap = {{"KHR_materials_iridescence", {{"iridescenceFactor", 1}}}};
  const Json brushed = {{"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}}}};
  const Scene s = scene_with(
      {named("bubble", soap), named("film", soap), named("", brushed),
       named("lens", {{"KHR_materials_dispersion", {{"dispersion", 0.1}}}}),
       named("leaf", {{"KHR_materials_diffuse_transmission", {{"diffuseTransmissionFactor", 1}}}}),
       named("wax", {{"KHR_materials_volume_scatter", {{"multiscatterColor", {0.5, 0, 0}}}}}),
       named("odd", {{"EXT_materials_glitter", Json::object()}})});
  EXPECT_EQ(s.warnings,
            (Sentences{"EXT_materials_glitter is left out: material \"odd\"",
                       "anisotropy is left out: materials[2]",
                       "diffuse transmission is left out: material \"leaf\"",
                       "dispersion is left out: material \"lens\"",
                       "iridescence is left out: material \"bubble\", material \"film\"",
                       "scattering in its volume is left out: material \"wax\""}));
}

TEST(Materials, ExtensionsThatNobodyKnowsDoNotDrownTheRest) {
  Json m = lambert(0.9, 0.9, 0.9);
  m["extensions"]["KHR_materials_iridescence"]["iridescenceFactor"] = 1;
  for (int k = 0; k < 20; ++k) m["extensions"]["A_materials_" + std::to_string(k)] = Json::object();
  const Scene s = scene_with({m});
  ASSERT_EQ(s.warnings.size(), 17u);
  EXPECT_EQ(s.warnings[0], "A_materials_0 is left out: materials[0]");
  EXPECT_EQ(s.warnings[16], "5 more approximations");
}

TEST(Materials, WhatIsLeftOutMayBeRequired) {
  GlbBuilder b;
  b.json["extensionsRequired"] = {"KHR_materials_iridescence", "KHR_materials_diffuse_transmission",
                                  "KHR_materials_volume_scatter"};
  EXPECT_EQ(scene_with({lambert(0.5, 0.5, 0.5)}, b).warnings, Sentences{});
}

TEST(Materials, BaseColoursAboveOneAreClamped) {
  const Scene s = scene_with({lambert(1.5, 0.2, 0.2)});
  EXPECT_EQ(s.warnings, Sentences{"base colours above 1 are clamped to 1: materials[0]"});
  EXPECT_EQ(s.materials[0].base_color, Rgb(1, 0.2f, 0.2f));
}

/// A material of the specular-glossiness model.
Json glossy(const Json& model) {
  return {{"name", "glossy"},
          {"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}},
          {"extensions", {{"KHR_materials_pbrSpecularGlossiness", model}}}};
}

TEST(SpecularGlossiness, ReflectsItsSpecularColourAndDiffusesTheRest) {
  const Material m = material(glossy({{"diffuseFactor", {0.5, 0.25, 1, 1}},
                                      {"specularFactor", {0.25, 0.5, 0.125}},
                                      {"glossinessFactor", 0.75}}));
  EXPECT_EQ(m.base_color, Rgb(0.25f, 0.125f, 0.5f));
  EXPECT_EQ(m.specular_color, Rgb(0.25f, 0.5f, 0.125f));
  EXPECT_EQ(m.specular, 1);
  EXPECT_EQ(m.metallic, 0);
  EXPECT_EQ(m.roughness, 0.25f);
  const float r = (m.ior - 1) / (m.ior + 1);
  EXPECT_NEAR(r * r, 1, 1e-5);
  EXPECT_FALSE(m.glossy_map);
  EXPECT_EQ(m.name, "glossy");
  const Material mirror = material(glossy(Json::object()));  // a white one unless it says more
  EXPECT_EQ(mirror.base_color, Rgb(0.0f));
  EXPECT_EQ(mirror.specular_color, Rgb(1.0f));
  EXPECT_EQ(mirror.roughness, 0);
}

TEST(SpecularGlossiness, ATextureOfOneColourBecomesFactors) {
  const Material m = material(
      glossy({{"specularFactor", {0.5, 1, 1}}, {"specularGlossinessTexture", {{"index", 0}}}}),
      with(kOne));
  EXPECT_FALSE(m.maps[MAP_SPECULAR_COLOR]);
  EXPECT_FALSE(m.glossy_map);
  EXPECT_NEAR(m.specular_color.x, 0.5, 1e-6);
  EXPECT_NEAR(m.specular_color.y, linear(0.2), 1e-6);
  EXPECT_NEAR(m.roughness, 0.4, 1e-6);  // alpha is not encoded
  EXPECT_NEAR(m.base_color.x, 0.5, 1e-6);
}

TEST(SpecularGlossiness, ATextureIsKeptWithItsGlossiness) {
  const Json model = {{"diffuseTexture", {{"index", 0}}},
                      {"specularFactor", {0, 0, 0}},
                      {"glossinessFactor", 0.5},
                      {"specularGlossinessTexture", {{"index", 0}}}};
  Json m = glossy(model);
  m["alphaMode"] = "BLEND";
  const Material read = material(m, with(kTwo));
  EXPECT_TRUE(read.glossy_map);
  EXPECT_TRUE(read.maps[MAP_SPECULAR_COLOR]);  // its alpha matters where its colours do not
  EXPECT_TRUE(read.maps[MAP_SPECULAR_COLOR].srgb);
  EXPECT_TRUE(read.maps[MAP_BASE]);
  EXPECT_EQ(read.roughness, 0.5f);
  EXPECT_EQ(read.base_color, Rgb(1.0f));
  EXPECT_EQ(read.alpha_mode, Material::Alpha::blend);
}

TEST(SpecularGlossiness, StandsAloneBesideOtherModels) {
  Json m = glossy({{"specularFactor", {0.5, 0.5, 0.5}}});
  m["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", 1}};
  m["extensions"]["KHR_materials_specular"] = {{"specularFactor", 0}};
  m["extensions"]["KHR_materials_ior"] = {{"ior", 1.1}};
  const Material read = material(m);
  EXPECT_EQ(read.transmission, 0);
  EXPECT_EQ(read.specular, 1);
  EXPECT_GT(read.ior, 1e5);
}

TEST(Materials, SurfacesWithoutOneAreGrey) {
  GlbBuilder b;
  const int p = b.floats({0, 0, 0, 2, 0, 0, 0, 1, 0}, 3);
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}})}});
  const Scene s = load(b);
  EXPECT_EQ(s.material_of(0).base_color, Rgb(0.8f));
  EXPECT_TRUE(s.material_of(0).plain);
  EXPECT_EQ(s.warnings, Sentences{"surfaces without a material are taken as diffuse grey of 0.8"});
}

}  // namespace tdpt::testing::materials_test
