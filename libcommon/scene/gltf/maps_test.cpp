// Which maps and images of materials are kept, and the warnings and needs that they cause.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "libcommon/scene/texture.h"
#include "libcommon/testing/scenes/materials.h"
#include "libcommon/testing/scenes/needs.h"

namespace tdpt::testing::maps_test {

const std::string kKtx = "\xabKTX 20\xbb\r\n\x1a\n";
const std::string kNotRead = "textures that are not read are left out: ";

/// A material whose maps, all of them, are textures 0, 1, ... in the order of kMaps.
struct NamedMap {
  const char* at;
  uint32_t map;
};
constexpr NamedMap kMaps[] = {
    {"/pbrMetallicRoughness/baseColorTexture", MAP_BASE},
    {"/pbrMetallicRoughness/metallicRoughnessTexture", MAP_METALLIC_ROUGHNESS},
    {"/normalTexture", MAP_NORMAL},
    {"/emissiveTexture", MAP_EMISSION},
    {"/extensions/KHR_materials_specular/specularTexture", MAP_SPECULAR},
    {"/extensions/KHR_materials_specular/specularColorTexture", MAP_SPECULAR_COLOR},
    {"/extensions/KHR_materials_transmission/transmissionTexture", MAP_TRANSMISSION},
    {"/extensions/KHR_materials_clearcoat/clearcoatTexture", MAP_COAT},
    {"/extensions/KHR_materials_clearcoat/clearcoatRoughnessTexture", MAP_COAT_ROUGHNESS},
    {"/extensions/KHR_materials_clearcoat/clearcoatNormalTexture", MAP_COAT_NORMAL},
    {"/extensions/KHR_materials_sheen/sheenColorTexture", MAP_SHEEN_COLOR},
    {"/extensions/KHR_materials_sheen/sheenRoughnessTexture", MAP_SHEEN_ROUGHNESS}};

Json with_factors() {
  return Json::parse(R"({"alphaMode": "BLEND", "emissiveFactor": [10, 10, 10],
    "pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 0.25, 1],
      "metallicFactor": 0.5, "roughnessFactor": 0.5},
    "extensions": {
      "KHR_materials_specular": {"specularFactor": 0.5},
      "KHR_materials_transmission": {"transmissionFactor": 0.5},
      "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.5},
      "KHR_materials_sheen": {"sheenColorFactor": [1, 1, 0.5], "sheenRoughnessFactor": 0.5}}})");
}

TEST(Maps, EveryOneFindsItsPlace) {
  Json m = with_factors();
  m["occlusionTexture"] = {{"index", 12}};
  GlbBuilder b;
  for (int k = 0; k < 13; ++k) {  // the first byte distinguishes the images
    b.texture(png_of(2, 1, std::string({char(100 + k), 1, 2, 3, 4, 5, 6, 7})));
    if (k < 12) m[Json::json_pointer(kMaps[k].at)] = {{"index", k}, {"scale", 0.5}};
  }
  const Scene s = scene_with({m}, b);
  const Material& out = s.materials[0];
  for (int k = 0; k < 12; ++k) {
    const TextureMap& map = out.maps[kMaps[k].map];
    ASSERT_TRUE(map) << kMaps[k].at;
    EXPECT_EQ(s.images[static_cast<size_t>(map.image)].texels[0], 100 + k) << kMaps[k].at;
    const std::string name = kMaps[k].at;
    EXPECT_EQ(map.srgb, name.ends_with("ColorTexture") || name == "/emissiveTexture") << name;
  }
  EXPECT_EQ(s.images.size(), 12u);  // occlusion textures are not used
  EXPECT_EQ(out.normal_scale, 0.5f);
  EXPECT_EQ(out.coat_normal_scale, 0.5f);
  EXPECT_EQ(needs_of(s), (Sentences{"textures", "specular", "transmission", "clear coat", "sheen",
                                    "alpha", "normal maps", "textured emission"}));
  EXPECT_EQ(s.warnings, Sentences{});
}

TEST(Maps, OfASingleColourBecomeFactors) {
  Json m = with_factors();
  for (const NamedMap& map : kMaps)
    if (!std::string(map.at).ends_with("ormalTexture"))
      m[Json::json_pointer(map.at)] = {{"index", 0}};
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
  EXPECT_NEAR(out.coat, 0.5, 1e-6);                   // R
  EXPECT_NEAR(out.coat_roughness, 0.5 * 0.2, 1e-6);   // G
  EXPECT_NEAR(out.sheen_color.y, linear(0.2), 1e-6);  // RGB
  EXPECT_NEAR(out.sheen_color.z, 0.5 * linear(0.4), 1e-6);
  EXPECT_NEAR(out.sheen_roughness, 0.5 * 0.6, 1e-6);  // A
  EXPECT_TRUE(s.images.empty());
  EXPECT_EQ(needs_of(s), (Sentences{"specular", "transmission", "clear coat", "sheen", "alpha"}));
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

TEST(Maps, TransformsScaleThenTurnThenMove) {
  const double pi = std::acos(-1.0);
  const auto expect = [&](const Json& t, const std::array<float, 6>& transform) {
    const Json info = {{"index", 0}, {"extensions", {{"KHR_texture_transform", t}}}};
    const TextureMap map = material(textured(info), with(kTwo)).maps[MAP_BASE];
    for (size_t k = 0; k < 6; ++k) EXPECT_NEAR(map.transform[k], transform[k], 1e-6) << k;
    EXPECT_EQ(map.uv_set, t.value("texCoord", 0));
  };
  expect({{"offset", {0.25, -3}}, {"scale", {2, 5}}, {"texCoord", 1}}, {2, 0, 0.25f, 0, 5, -3});
  // The lower left quarter of the image, rotated clockwise by a right angle: the specification's
  // own example. (0,0) -> (0,1), (1,0) -> (0,0.5), (0,1) -> (0.5,1).
  expect({{"offset", {0, 1}}, {"rotation", pi / 2}, {"scale", {0.5, 0.5}}},
         {0, 0.5f, 0, -0.5f, 0, 1});
  // Non-uniform scale shows the order: u is scaled before it becomes v.
  expect({{"rotation", pi / 2}, {"scale", {2, 5}}}, {0, 5, 0, -2, 0, 0});
}

TEST(Maps, ThoseThatChangeNothingAreNotRead) {
  Json m = lambert(0, 0, 0);  // black, diffuse
  for (const NamedMap& map : kMaps) m[Json::json_pointer(map.at)] = {{"index", 0}};
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

TEST(Images, AndCoordinatesAreKeptOnceAndOnlyWhereTheyAreLookedUp) {
  GlbBuilder b = with(kTwo);
  b.texture("no image");
  b.material(textured({{"index", 1}}));  // that nothing uses
  const Json of_one = textured({{"index", 0}, {"texCoord", 1}});
  const Scene s = scene_with({of_one, of_one}, b);
  ASSERT_EQ(s.images.size(), 1u);
  EXPECT_EQ(s.images[0].width, 2);
  EXPECT_EQ(s.images[0].height, 1);
  EXPECT_EQ(std::string(s.images[0].texels.begin(), s.images[0].texels.end()), kTwoTexels);
  EXPECT_EQ(s.materials[1].maps[MAP_BASE].image, 0);
  EXPECT_EQ(s.materials[2].maps[MAP_BASE].image, 0);
  EXPECT_FALSE(s.materials[1].plain);
  EXPECT_TRUE(s.uv[0].empty());
  ASSERT_EQ(s.uv[1].size(), 6u);
  EXPECT_EQ(s.uv[1][1], (std::array<float, 2>{1, 0}));
  EXPECT_EQ(needs_of(s), Sentences{"textures"});
  EXPECT_EQ(s.warnings, Sentences{});
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
    folder.write("maps/two texels.png", kTwoOpaque);  // a texture file is part of the scene's hash
    EXPECT_EQ(read_gltf(path).hash != s.hash, uri.starts_with("maps"));
  }
}

// The factor remains, and what is left out is told.
TEST(Images, ThatAreNotReadLeaveTheFactor) {
  const auto told = [](const GlbBuilder& b, const std::string& what_is, int uv_set = 0) {
    const Scene s = scene_with({textured({{"index", 0}, {"texCoord", uv_set}})}, b);
    EXPECT_EQ(s.materials[0].base_color, Rgb(0.5f, 1, 0.25f));
    EXPECT_TRUE(s.materials[0].plain);
    EXPECT_EQ(s.warnings, Sentences{kNotRead + "materials[0] baseColorTexture (" + what_is + ")"});
  };
  std::string huge = kTwo;  // claims 2^16 x 2^16 texels
  huge.replace(16, 8, std::string("\0\1\0\0\0\1\0\0", 8));
  const std::string no_png = "a PNG that cannot be decoded";
  told(with("RIFF1234WEBP"), "a WebP that cannot be decoded");
  told(with(std::string("RIFF\x1a\0\0\0WEBPVP8X\x0a\0\0\0\x02\0\0\0\1\0\0\1\0\0", 30)),
       "an animated WebP, which is not read");
  told(with(kKtx), "KTX2, which is not read");
  told(with("DDS |"), "DDS, which is not read");
  told(with(std::string("\0\0\0\x20"
                        "ftypavif",
                        12)),
       "AVIF, which is not read");
  told(with("P6 2 1 255\n\1\2\3\4\5\6"), "of a format that is not known");
  told(with("\xff\xd8\xff"), "a JPEG that cannot be decoded");
  told(with(kTwo.substr(0, 40)), no_png);
  told(with(huge), no_png);
  told(with("\x89PNG\r\n\x1a\n"), no_png);
  told(with(kTwo), "on TEXCOORD_2", 2);
  GlbBuilder b = with(kTwo);
  b.json["textures"][0].erase("source");
  told(b, "without an image");
  b = with(kTwo);
  b.json["images"][0] = {{"uri", "no%20where.png"}};
  told(b, "a file that is missing, \"no where.png\"");
  b.json["images"][0] = {{"uri", "data:image/png;base64,A*=="}};
  told(b, "a data URI that cannot be decoded");
}

TEST(Images, OfManyMaterialsAreNamedUpToThree) {
  std::vector<Json> all(7, textured({{"index", 0}}));
  for (size_t i = 0; i < all.size(); ++i) all[i]["name"] = "wall\n" + std::to_string(i);
  const auto wall = [](int i) {
    return fmt::format("material \"wall?{}\" baseColorTexture (DDS, which is not read)", i);
  };
  EXPECT_EQ(scene_with(all, with("DDS |")).warnings,
            Sentences{kNotRead + wall(0) + ", " + wall(1) + ", " + wall(2) + " and 4 more"});
}

TEST(Images, OfAnExtensionComeFirstAndTheOthersWhereTheyAreNotRead) {
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
    EXPECT_EQ(colour(name, kKtx, true).warnings, Sentences{});
    EXPECT_EQ(colour(name, kKtx, true).images.size(), 1u);
    EXPECT_EQ(colour(name, kKtx, false).warnings,
              Sentences{kNotRead + "materials[0] baseColorTexture (KTX2, which is not read)"});
  }
  EXPECT_EQ(colour("EXT_texture_webp", kTwo, true).images[0].texels,
            scene_with({textured({{"index", 0}})}, with(kTwo)).images[0].texels);
  EXPECT_EQ(colour("EXT_texture_webp", kKtx, true).images[0].texels,
            scene_with({textured({{"index", 0}})}, with(kTwoOpaque)).images[0].texels);
  EXPECT_EQ(colour("EXT_texture_webp", "RIFF1234WEBP", true).warnings, Sentences{});
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
