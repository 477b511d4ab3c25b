// Which maps and images of materials are kept, and the warnings and needs that they cause.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "libcommon/scene/texture.h"
#include "libcommon/testing/scenes/materials.h"
#include "libcommon/testing/scenes/needs.h"

namespace tdpt::testing::maps_test {

const std::string kNotRead = "textures that are not read are left out: ";

TEST(Maps, EveryOneFindsItsPlace) {
  Json m = lambert(0.5, 0.5, 0.5);
  const auto info = [](int index) { return Json{{"index", index}}; };
  m["pbrMetallicRoughness"]["metallicFactor"] = 0.5;
  m["pbrMetallicRoughness"]["baseColorTexture"] = info(0);
  m["pbrMetallicRoughness"]["metallicRoughnessTexture"] = info(1);
  m["normalTexture"] = {{"index", 2}, {"scale", 0.5}};
  m["emissiveTexture"] = info(3);
  m["emissiveFactor"] = {1, 1, 1};
  m["occlusionTexture"] = info(7);
  m["extensions"]["KHR_materials_specular"] = {{"specularTexture", info(4)},
                                               {"specularColorTexture", info(5)}};
  m["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", 1},
                                                   {"transmissionTexture", info(6)}};
  GlbBuilder b;
  for (char k = 0; k < 8; ++k)  // the first byte distinguishes the images
    b.texture(png_of(2, 1, std::string({char(100 + k), 1, 2, 3, 4, 5, 6, 7})));
  const Scene s = scene_with({m}, b);
  const Material& out = s.materials[0];
  const auto image = [&](const TextureMap& map) {
    return map ? s.images[static_cast<size_t>(map.image)].texels[0] : 0;
  };
  EXPECT_EQ(image(out.maps[MAP_BASE]), 100);
  EXPECT_EQ(image(out.maps[MAP_METALLIC_ROUGHNESS]), 101);
  EXPECT_EQ(image(out.maps[MAP_NORMAL]), 102);
  EXPECT_EQ(image(out.maps[MAP_EMISSION]), 103);
  EXPECT_EQ(image(out.maps[MAP_SPECULAR]), 104);
  EXPECT_EQ(image(out.maps[MAP_SPECULAR_COLOR]), 105);
  EXPECT_EQ(image(out.maps[MAP_TRANSMISSION]), 106);
  EXPECT_EQ(s.images.size(), 7u);  // occlusion textures are not used
  EXPECT_TRUE(out.maps[MAP_BASE].srgb && out.maps[MAP_EMISSION].srgb &&
              out.maps[MAP_SPECULAR_COLOR].srgb);
  EXPECT_FALSE(out.maps[MAP_METALLIC_ROUGHNESS].srgb || out.maps[MAP_NORMAL].srgb ||
               out.maps[MAP_SPECULAR].srgb || out.maps[MAP_TRANSMISSION].srgb);
  EXPECT_EQ(out.normal_scale, 0.5f);
  EXPECT_EQ(needs_of(s), (Sentences{"textures", "specular", "transmission", "normal maps",
                                    "textured emission"}));
  EXPECT_EQ(s.warnings, Sentences{});
}

TEST(Maps, OfCoatAndSheenFindTheirPlaces) {
  Json m = lambert(0.5, 0.5, 0.5);
  const auto info = [](int index) { return Json{{"index", index}}; };
  m["extensions"]["KHR_materials_clearcoat"] = {
      {"clearcoatFactor", 1},
      {"clearcoatRoughnessFactor", 1},
      {"clearcoatTexture", info(0)},
      {"clearcoatRoughnessTexture", info(1)},
      {"clearcoatNormalTexture", {{"index", 2}, {"scale", 0.5}}}};
  m["extensions"]["KHR_materials_sheen"] = {{"sheenColorFactor", {1, 1, 1}},
                                            {"sheenRoughnessFactor", 1},
                                            {"sheenColorTexture", info(3)},
                                            {"sheenRoughnessTexture", info(4)}};
  GlbBuilder b;
  for (char k = 0; k < 5; ++k)
    b.texture(png_of(2, 1, std::string({char(100 + k), 1, 2, 3, 4, 5, 6, 7})));
  const Scene s = scene_with({m}, b);
  const Material& out = s.materials[0];
  int expected = 100;
  for (const TextureMap* map :
       {&out.maps[MAP_COAT], &out.maps[MAP_COAT_ROUGHNESS], &out.maps[MAP_COAT_NORMAL],
        &out.maps[MAP_SHEEN_COLOR], &out.maps[MAP_SHEEN_ROUGHNESS]}) {
    ASSERT_TRUE(*map);
    EXPECT_EQ(s.images[static_cast<size_t>(map->image)].texels[0], expected++);
    EXPECT_EQ(map->srgb, map == &out.maps[MAP_SHEEN_COLOR]);
  }
  EXPECT_EQ(out.coat_normal_scale, 0.5f);
  EXPECT_EQ(needs_of(s), (Sentences{"textures", "clear coat", "sheen", "normal maps"}));
}

TEST(Maps, OfCoatAndSheenOfASingleColourBecomeFactors) {
  Json m = lambert(0.5, 0.5, 0.5);
  const Json one = {{"index", 0}};
  m["extensions"]["KHR_materials_clearcoat"] = {{"clearcoatFactor", 0.5},
                                                {"clearcoatRoughnessFactor", 0.5},
                                                {"clearcoatTexture", one},
                                                {"clearcoatRoughnessTexture", one}};
  m["extensions"]["KHR_materials_sheen"] = {{"sheenColorFactor", {1, 1, 0.5}},
                                            {"sheenRoughnessFactor", 0.5},
                                            {"sheenColorTexture", one},
                                            {"sheenRoughnessTexture", one}};
  const Scene s = scene_with({m}, with(kOne));
  const Material& out = s.materials[0];
  EXPECT_NEAR(out.coat, 0.5, 1e-6);                   // R
  EXPECT_NEAR(out.coat_roughness, 0.5 * 0.2, 1e-6);   // G
  EXPECT_NEAR(out.sheen_color.y, linear(0.2), 1e-6);  // RGB
  EXPECT_NEAR(out.sheen_color.z, 0.5 * linear(0.4), 1e-6);
  EXPECT_NEAR(out.sheen_roughness, 0.5 * 0.6, 1e-6);  // A
  EXPECT_TRUE(s.images.empty());
}

Json textured(const Json& info) {
  Json m = lambert(0.5, 1, 0.25);
  m["pbrMetallicRoughness"]["baseColorTexture"] = info;
  return m;
}

TEST(Maps, SamplersSayHowTheyAreWrapped) {
  TextureMap map = material(textured({{"index", 0}}), with(kTwo)).maps[MAP_BASE];
  EXPECT_EQ(map.wrap_u, Wrap::repeat);
  EXPECT_EQ(map.wrap_v, Wrap::repeat);
  EXPECT_FALSE(map.nearest);
  EXPECT_EQ(map.uv_set, 0);
  map = material(textured({{"index", 0}, {"texCoord", 1}}),
                 with(kTwo, {{"wrapS", 33648}, {"wrapT", 33071}, {"magFilter", 9728}}))
            .maps[MAP_BASE];
  EXPECT_EQ(map.wrap_u, Wrap::mirror);
  EXPECT_EQ(map.wrap_v, Wrap::clamp);
  EXPECT_TRUE(map.nearest);
  EXPECT_EQ(map.uv_set, 1);
  EXPECT_FALSE(
      material(textured({{"index", 0}}), with(kTwo, {{"magFilter", 9729}, {"minFilter", 9728}}))
          .maps[MAP_BASE]
          .nearest);
}

TEST(Maps, OnlyTheCoordinatesThatTheyLookUpAreKept) {
  const Scene s = scene_with({textured({{"index", 0}, {"texCoord", 1}})}, with(kTwo));
  EXPECT_TRUE(s.uv[0].empty());
  ASSERT_EQ(s.uv[1].size(), 3u);
  EXPECT_EQ(s.uv[1][1], (std::array<float, 2>{1, 0}));
}

TEST(Maps, TransformsScaleThenTurnThenMove) {
  const double pi = std::acos(-1.0);
  const auto transform = [&](const Json& t) {
    return material(textured({{"index", 0}, {"extensions", {{"KHR_texture_transform", t}}}}),
                    with(kTwo))
        .maps[MAP_BASE]
        .transform;
  };
  const auto expect = [](const std::array<float, 6>& a, const std::array<float, 6>& b) {
    for (size_t k = 0; k < 6; ++k) EXPECT_NEAR(a[k], b[k], 1e-6) << k;
  };
  expect(transform({{"offset", {0.25, -3}}, {"scale", {2, 5}}}), {2, 0, 0.25f, 0, 5, -3});
  // The lower left quarter of the image, rotated clockwise by a right angle: the specification's
  // own example. (0,0) -> (0,1), (1,0) -> (0,0.5), (0,1) -> (0.5,1).
  expect(transform({{"offset", {0, 1}}, {"rotation", pi / 2}, {"scale", {0.5, 0.5}}}),
         {0, 0.5f, 0, -0.5f, 0, 1});
  // Non-uniform scale shows the order: u is scaled before it becomes v.
  expect(transform({{"rotation", pi / 2}, {"scale", {2, 5}}}), {0, 5, 0, -2, 0, 0});
  EXPECT_EQ(material(textured({{"index", 0},
                               {"extensions", {{"KHR_texture_transform", {{"texCoord", 1}}}}}}),
                     with(kTwo))
                .maps[MAP_BASE]
                .uv_set,
            1);
}

TEST(Maps, OneOfASingleColourBecomesAFactor) {
  Json m = textured({{"index", 0}});
  m["alphaMode"] = "BLEND";
  m["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", 0}};
  m["pbrMetallicRoughness"]["metallicFactor"] = 0.5;
  m["pbrMetallicRoughness"]["roughnessFactor"] = 0.5;
  m["emissiveFactor"] = {10, 10, 10};
  m["emissiveTexture"] = {{"index", 0}};
  m["extensions"]["KHR_materials_specular"] = {{"specularFactor", 0.5},
                                               {"specularTexture", {{"index", 0}}},
                                               {"specularColorTexture", {{"index", 0}}}};
  m["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", 0.5},
                                                   {"transmissionTexture", {{"index", 0}}}};
  const Scene s = scene_with({m}, with(kOne));
  const Material& out = s.materials[0];
  EXPECT_NEAR(out.base_color.x, 0.5, 1e-6);
  EXPECT_NEAR(out.base_color.y, linear(0.2), 1e-6);
  EXPECT_NEAR(out.base_color.z, 0.25 * linear(0.4), 1e-6);
  EXPECT_NEAR(out.alpha, 0.6, 1e-6);
  EXPECT_NEAR(out.roughness, 0.5 * 0.2, 1e-6);
  EXPECT_NEAR(out.metallic, 0.5 * 0.4, 1e-6);
  EXPECT_NEAR(out.emission.y, 10 * linear(0.2), 1e-5);
  EXPECT_NEAR(out.specular, 0.5 * 0.6, 1e-6);
  EXPECT_NEAR(out.specular_color.z, linear(0.4), 1e-6);
  EXPECT_NEAR(out.transmission, 0.5, 1e-6);
  EXPECT_TRUE(s.images.empty());
  EXPECT_EQ(needs_of(s), (Sentences{"specular", "transmission", "alpha"}));
}

TEST(Maps, ThoseThatChangeNothingAreNotRead) {
  const Json broken = {{"index", 0}};
  Json m = lambert(0, 0, 0);  // black, diffuse
  m["pbrMetallicRoughness"]["baseColorTexture"] = broken;
  m["pbrMetallicRoughness"]["metallicRoughnessTexture"] = broken;
  m["emissiveTexture"] = broken;
  m["normalTexture"] = broken;
  m["extensions"]["KHR_materials_specular"]["specularTexture"] = broken;
  m["extensions"]["KHR_materials_specular"]["specularColorTexture"] = broken;
  m["extensions"]["KHR_materials_transmission"]["transmissionTexture"] = broken;
  const Scene s = scene_with({m}, with("no image"));
  EXPECT_EQ(s.warnings, Sentences{});
  EXPECT_TRUE(s.materials[0].plain);
  m["pbrMetallicRoughness"]["baseColorFactor"] = {0.1, 0, 0, 1};
  EXPECT_EQ(scene_with({m}, with("no image")).warnings,
            Sentences{kNotRead + "materials[0] baseColorTexture (of a format that is not known), "
                                 "materials[0] normalTexture (of a format that is not known)"});
}

TEST(Maps, AFlatNormalMapIsNone) {
  Json m = lambert(0.5, 0.5, 0.5);
  m["normalTexture"] = {{"index", 0}};
  EXPECT_TRUE(material(m, with(png_of(1, 1, "\x80\x80\xff\xff"))).plain);
  EXPECT_TRUE(material(m, with(png_of(1, 1, "\x7f\x80\xff\xff"))).plain);
  EXPECT_TRUE(material(m, with(png_of(1, 1, "\x90\x80\xff\xff"))).maps[MAP_NORMAL]);
  m["normalTexture"]["scale"] = 0;
  EXPECT_FALSE(material(m, with(png_of(1, 1, "\x90\x80\xff\xff"))).maps[MAP_NORMAL]);
}

TEST(Images, AreKeptOnceHoweverManyUseThem) {
  const Scene s =
      scene_with({textured({{"index", 0}}), textured({{"index", 0}, {"texCoord", 1}})}, with(kTwo));
  ASSERT_EQ(s.images.size(), 1u);
  EXPECT_EQ(s.images[0].width, 2);
  EXPECT_EQ(s.images[0].height, 1);
  EXPECT_EQ(std::string(s.images[0].texels.begin(), s.images[0].texels.end()), kTwoTexels);
  EXPECT_EQ(s.materials[0].maps[MAP_BASE].image, 0);
  EXPECT_EQ(s.materials[1].maps[MAP_BASE].image, 0);
  EXPECT_FALSE(s.materials[0].plain);
  EXPECT_EQ(needs_of(s), Sentences{"textures"});
}

TEST(Images, OfMaterialsThatNothingUsesAreNotRead) {
  GlbBuilder b = with("no image");
  b.material(textured({{"index", 0}}));
  EXPECT_EQ(scene_with({lambert(1, 1, 1)}, b).warnings, Sentences{});
}

TEST(Images, SixteenBitsBecomeEight) {
  const std::string wide("\x12\x34\x80\x00\xff\xff\xff\xff\0\0\0\0\0\0\xff\xff", 16);
  const Scene s = scene_with({textured({{"index", 0}})}, with(png_of(2, 1, wide, 16)));
  ASSERT_EQ(s.images.size(), 1u);
  EXPECT_EQ(s.images[0].texels, (std::vector<uint8_t>{0x12, 0x80, 0xff, 0xff, 0, 0, 0, 0xff}));
}

TEST(Images, MayBeJpeg) {
  GlbBuilder b = with("unused");
  b.json["images"][0] = {{"uri", std::string("data:image/jpeg;base64,") + kJpeg}};
  const Scene s = scene_with({textured({{"index", 0}})}, b);
  ASSERT_EQ(s.images.size(), 1u);
  const Image& i = s.images[0];
  EXPECT_EQ(i.width, 16);
  EXPECT_EQ(i.height, 8);
  EXPECT_NEAR(i.texels[0], 255, 3);           // red on the left
  EXPECT_NEAR(i.texels[4 * 15 + 2], 255, 3);  // blue on the right
  EXPECT_EQ(i.texels[3], 255);
}

TEST(Images, FromDataUrisAndFilesOfTheFolder) {
  for (const std::string& uri :
       {"data:image/png;base64," + base64(kTwo), std::string("maps/two%20texels.png")}) {
    GlbBuilder b = with("unused");
    b.json["images"][0] = {{"uri", uri}};
    const int p = b.floats({0, 0, 0, 2, 0, 0, 0, 1, 0}, 3);
    const int index = b.material(textured({{"index", 0}}));
    b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}, {"material", index}})}});
    const TempFolder folder;
    folder.write("maps/two texels.png", kTwo);
    const std::string path = folder.write("scene.glb", b.glb());
    const Scene s = read_gltf(path);
    ASSERT_EQ(s.images.size(), 1u) << uri;
    EXPECT_EQ(std::string(s.images[0].texels.begin(), s.images[0].texels.end()), kTwoTexels);
    EXPECT_EQ(s.warnings, Sentences{"texture coordinates that a material asks for are missing, "
                                    "taken as 0: meshes[0].primitives[0]"});
    folder.write("maps/two texels.png", kTwoOpaque);  // a texture file is part of the scene's hash
    EXPECT_EQ(read_gltf(path).hash != s.hash, uri.starts_with("maps"));
  }
}

TEST(Images, ThatCannotBeDecodedLeaveTheFactor) {
  std::string huge = kTwo;  // claims 2^16 x 2^16 texels
  huge.replace(16, 8, std::string("\0\1\0\0\0\1\0\0", 8));
  const std::string no_png = "a PNG that cannot be decoded";
  const std::vector<std::pair<std::string, std::string>> all{
      {"RIFF1234WEBP", "a WebP that cannot be decoded"},
      {std::string("RIFF\x1a\0\0\0WEBPVP8X\x0a\0\0\0\x02\0\0\0\1\0\0\1\0\0", 30),
       "an animated WebP, which is not read"},
      {"\xabKTX 20\xbb\r\n\x1a\n", "KTX2, which is not read"},
      {"DDS |", "DDS, which is not read"},
      {std::string("\0\0\0\x20"
                   "ftypavif",
                   12),
       "AVIF, which is not read"},
      {"P6 2 1 255\n\1\2\3\4\5\6", "of a format that is not known"},
      {kTwo.substr(0, 40), no_png},
      {huge, no_png},
      {"\xff\xd8\xff", "a JPEG that cannot be decoded"},
      {"\x89PNG\r\n\x1a\n", no_png}};
  for (const auto& [image, what_is] : all) {
    const Scene s = scene_with({textured({{"index", 0}})}, with(image));
    EXPECT_EQ(s.materials[0].base_color, Rgb(0.5f, 1, 0.25f));
    EXPECT_TRUE(s.materials[0].plain);
    EXPECT_EQ(s.warnings, Sentences{kNotRead + "materials[0] baseColorTexture (" + what_is + ")"});
  }
  GlbBuilder none = with(kTwo);
  none.json["textures"][0].erase("source");
  EXPECT_EQ(scene_with({textured({{"index", 0}})}, none).warnings,
            Sentences{kNotRead + "materials[0] baseColorTexture (without an image)"});
}

TEST(Images, OfManyMaterialsAreNamedUpToThree) {
  std::vector<Json> all(7, textured({{"index", 0}}));
  for (size_t i = 0; i < all.size(); ++i) all[i]["name"] = "wall\n" + std::to_string(i);
  const Scene s = scene_with(all, with("DDS |"));
  const auto wall = [](int i) {
    return fmt::format("material \"wall?{}\" baseColorTexture (DDS, which is not read)", i);
  };
  EXPECT_EQ(s.warnings,
            Sentences{kNotRead + wall(0) + ", " + wall(1) + ", " + wall(2) + " and 4 more"});
}

TEST(Images, ThatAreNotThereOrNoBase64LeaveTheFactor) {
  const std::vector<std::pair<std::string, std::string>> all{
      {"no%20where.png", "a file that is missing, \"no where.png\""},
      {"data:image/png;base64,A*==", "a data URI that cannot be decoded"}};
  for (const auto& [uri, what_is] : all) {
    GlbBuilder b = with(kTwo);
    b.json["images"][0] = {{"uri", uri}};
    const Scene s = scene_with({textured({{"index", 0}})}, b);
    EXPECT_EQ(s.materials[0].base_color, Rgb(0.5f, 1, 0.25f));
    EXPECT_EQ(s.warnings, Sentences{kNotRead + "materials[0] baseColorTexture (" + what_is + ")"});
  }
}

TEST(Images, OfAnExtensionComeFirstAndTheOthersWhereTheyAreNotRead) {
  const std::string ktx = "\xabKTX 20\xbb\r\n\x1a\n";
  const auto colour = [&](const char* extension, const std::string& other, bool fallback) {
    GlbBuilder b = with(kTwoOpaque);
    b.texture(other);
    Json& t = b.json["textures"][0];
    if (!fallback) t.erase("source");
    t["extensions"][extension]["source"] = 1;
    b.json["extensionsUsed"] = b.json["extensionsRequired"] = Json::array({extension});
    return scene_with({textured({{"index", 0}})}, b);
  };
  for (const char* name : {"KHR_texture_basisu", "EXT_texture_avif", "MSFT_texture_dds"}) {
    EXPECT_EQ(colour(name, ktx, true).warnings, Sentences{});
    EXPECT_EQ(colour(name, ktx, true).images.size(), 1u);
    EXPECT_EQ(colour(name, ktx, false).warnings,
              Sentences{kNotRead + "materials[0] baseColorTexture (KTX2, which is not read)"});
  }
  EXPECT_EQ(colour("EXT_texture_webp", kTwo, true).images[0].texels,
            scene_with({textured({{"index", 0}})}, with(kTwo)).images[0].texels);
  EXPECT_EQ(colour("EXT_texture_webp", ktx, true).images[0].texels,
            scene_with({textured({{"index", 0}})}, with(kTwoOpaque)).images[0].texels);
  EXPECT_EQ(colour("EXT_texture_webp", "RIFF1234WEBP", true).warnings, Sentences{});
}

TEST(Images, OnAThirdSetOfCoordinatesLeaveTheFactor) {
  const Scene s = scene_with({textured({{"index", 0}, {"texCoord", 2}})}, with(kTwo));
  EXPECT_EQ(s.warnings, Sentences{kNotRead + "materials[0] baseColorTexture (on TEXCOORD_2)"});
  EXPECT_TRUE(s.materials[0].plain);
}

TEST(Alpha, OpaqueWhereItIsOneEverywhere) {
  const auto mode = [](const Json& m, const std::string& image) {
    return material(m, with(image)).alpha_mode;
  };
  Json m = textured({{"index", 0}});
  for (const char* name : {"BLEND", "MASK"}) {
    m["alphaMode"] = name;
    EXPECT_EQ(mode(m, kTwoOpaque), Material::Alpha::opaque);
  }
  m["alphaMode"] = "BLEND";
  EXPECT_EQ(mode(m, kTwo), Material::Alpha::blend);
  m["alphaMode"] = "OPAQUE";
  EXPECT_EQ(mode(m, kTwo), Material::Alpha::opaque);
  m["alphaMode"] = "MASK";
  EXPECT_EQ(mode(m, kTwo), Material::Alpha::opaque);  // 128 / 255 is above the cutoff of 0.5
  m["alphaCutoff"] = 0.75;
  EXPECT_EQ(mode(m, kTwo), Material::Alpha::mask);
  EXPECT_EQ(material(m, with(kTwo)).alpha_cutoff, 0.75f);
  m["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.5;
  EXPECT_EQ(mode(m, kTwoOpaque), Material::Alpha::mask);
  EXPECT_EQ(material(m, with(kTwo)).alpha, 0.5f);
}

TEST(Alpha, IsANeedAndNotPlain) {
  Json m = lambert(0.5, 0.5, 0.5);
  m["pbrMetallicRoughness"]["baseColorFactor"][3] = 0.25;
  EXPECT_TRUE(material(m).plain);  // opaque materials have no alpha
  EXPECT_EQ(material(m).alpha, 1);
  m["alphaMode"] = "BLEND";
  const Scene s = scene_with({m});
  EXPECT_FALSE(s.materials[0].plain);
  EXPECT_EQ(coverage_at(s, {0, 0.2, 0.2}), 0.25f);
  EXPECT_EQ(needs_of(s), Sentences{"alpha"});
  Json black = textured({{"index", 0}});  // its colour no longer matters, its holes do
  black["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 1};
  black["alphaMode"] = "BLEND";
  EXPECT_TRUE(material(black, with(kTwo)).maps[MAP_BASE]);
  EXPECT_FALSE(material(black, with(kTwoOpaque)).maps[MAP_BASE]);
  EXPECT_TRUE(material(black, with(kTwoOpaque)).plain);
}

}  // namespace tdpt::testing::maps_test
