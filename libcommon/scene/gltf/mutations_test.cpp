// Corrupted bytes and extreme numbers crash neither the reader nor the look-ups.
#include <gtest/gtest.h>
#include <cmath>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/gltf/textures.h"
#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/glb_builder.h"
#include "libcommon/testing/files/sound_scene.h"
#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/squares.h"
#include "libcommon/testing/scenes/materials.h"
#include "libcommon/testing/scenes/needs.h"

namespace tdpt::testing::mutations_test {

const std::string kTestdata = TDPT_TESTDATA;

size_t get_json_size(const std::string& glb) {
  return static_cast<unsigned char>(glb[12]) + 256u * static_cast<unsigned char>(glb[13]);
}

TEST(Mutations, ALoadedOrARefusedScene) {
  const TempFolder folder;
  const std::string whole = read_file(kTestdata + "/scenes/two-rooms.glb");
  const size_t json_end =
      20 + static_cast<unsigned char>(whole[12]) + 256 * static_cast<unsigned char>(whole[13]);
  int loaded = 0, refused = 0;
  for (uint64_t i = 0; i < 2000; ++i) {
    Rng rng(20, 0, i);
    std::string bytes = whole;
    const uint64_t what = rng.below(10);
    // Most changes go where they do most harm: to the header and the JSON.
    const size_t reach = what < 7 ? json_end : bytes.size();
    for (uint32_t n = 1 + rng.below(3); n > 0; --n) {
      const size_t at = rng.below(static_cast<uint32_t>(reach));
      const bool digit = bytes[at] >= '0' && bytes[at] <= '9';
      bytes[at] = static_cast<char>(digit ? '0' + rng.below(10) : rng.below(256));
    }
    if (what == 9) bytes.resize(rng.below(static_cast<uint32_t>(bytes.size())));
    try {
      const Scene scene = read_gltf(folder.write("mutant.glb", bytes));
      ++loaded;
      for (const Triangle& t : scene.triangles) {
        for (uint32_t v : t.vertex) {
          ASSERT_LT(v, scene.positions.size());
          ASSERT_LE(std::abs(scene.positions[v].x), 2e9);  // what lies at the horizon
        }
        ASSERT_LT(t.material, scene.materials.size());
      }
    } catch (const Error& e) {
      ++refused;
      EXPECT_EQ(std::string(e.what()).find_first_of("\r\n"), std::string::npos) << i;
    }
  }
  EXPECT_GT(loaded, 200);
  EXPECT_GT(refused, 200);
}

/// Positions and lengths of the numbers in a JSON text.
std::vector<std::pair<size_t, size_t>> numbers_in(const std::string& text) {
  std::vector<std::pair<size_t, size_t>> numbers;
  bool quoted = false;
  for (size_t i = 0; i < text.size(); ++i) {
    quoted ^= text[i] == '"';
    if (quoted || !(std::isdigit(text[i]) || text[i] == '-')) continue;
    const size_t end = text.find_first_not_of("0123456789.-+e", i);
    numbers.push_back({i, end - i});
    i = end;
  }
  return numbers;
}

TEST(Mutations, ExtremeNumbersInTheJson) {
  const TempFolder folder;
  const std::string whole = read_file(kTestdata + "/scenes/door-ajar.glb");
  const std::string text = whole.substr(20, get_json_size(whole));
  const std::string bin = whole.substr(20 + text.size() + 8);
  const auto numbers = numbers_in(text);
  ASSERT_GT(numbers.size(), 100u);
  const std::vector<std::string> extremes = {
      "-1",  "0",    "1",     "3",     "255",    "65536",      "2147483647",           "2147483648",
      "0.5", "1e30", "1e300", "-1e30", "1e-300", "4294967295", "18446744073709551615", "null"};
  int loaded = 0, refused = 0;
  for (uint64_t i = 0; i < 1500; ++i) {
    Rng rng(21, 0, i);
    const auto [at, length] = numbers[rng.below(static_cast<uint32_t>(numbers.size()))];
    std::string mutant = text;
    mutant.replace(at, length, extremes[rng.below(static_cast<uint32_t>(extremes.size()))]);
    try {
      const Scene scene = read_gltf(folder.write("mutant.glb", glb_of(mutant, bin)));
      ++loaded;
      for (const Vec3f& p : scene.positions) ASSERT_TRUE(is_finite(p));
    } catch (const Error& e) {
      ++refused;
      EXPECT_EQ(std::string(e.what()).find_first_of("\r\n"), std::string::npos) << i;
    }
  }
  EXPECT_GT(loaded, 100);
  EXPECT_GT(refused, 500);
}

/// A scene with every attribute, map, extension and kind of light.
GlbBuilder rich() {
  GlbBuilder b;
  b.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  nlohmann::ordered_json at;
  at["POSITION"] = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.25f}, 3);
  at["NORMAL"] = b.floats({0, 0, 1, 0.6f, 0, 0.8f, 0, 0.6f, 0.8f, 0, 0, 1}, 3);
  at["TANGENT"] = b.floats({1, 0, 0, 1, 1, 0, 0, -1, 1, 0, 0, 1, 1, 0, 0, 1}, 4);
  at["TEXCOORD_0"] = b.floats({0, 0, 1, 0, 0, 1, 1, 1}, 2);
  at["TEXCOORD_1"] =
      b.accessor(b.view(std::string("\0\0\0\0\1\0\1\0\0\1\0\0\7\7\0\0", 16), 4), 5120, "VEC2", 4);
  at["COLOR_0"] = b.floats({1, 0, 0, 1, 0, 1, 0, 0.5f, 0, 0, 1, 1, 1, 1, 1, 1}, 4);
  const int index = b.view(std::string("\0\3", 2)), value = b.view(std::string(16, '\x3f'));
  b.json["accessors"][3]["sparse"] = {{"count", 2},
                                      {"indices", {{"bufferView", index}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", value}}}};
  b.texture(png_of(2, 2, "abcdefghijklmnop"), {{"wrapS", 33648}, {"wrapT", 33071}});
  const auto info = [](int uv) {
    return nlohmann::ordered_json{
        {"index", 0},
        {"texCoord", uv},
        {"extensions",
         {{"KHR_texture_transform", {{"offset", {1, 2}}, {"rotation", 3}, {"scale", {4, 5}}}}}}};
  };
  auto normal = info(1);
  normal["scale"] = 0.5;
  b.material({{"pbrMetallicRoughness",
               {{"baseColorFactor", {0.5, 0.5, 0.5, 0.5}},
                {"metallicFactor", 0.5},
                {"roughnessFactor", 0.5},
                {"baseColorTexture", info(0)},
                {"metallicRoughnessTexture", info(1)}}},
              {"normalTexture", normal},
              {"emissiveFactor", {1, 2, 3}},
              {"emissiveTexture", info(0)},
              {"alphaMode", "BLEND"},
              {"alphaCutoff", 0.25},
              {"extensions",
               {{"KHR_materials_specular",
                 {{"specularFactor", 0.5},
                  {"specularColorFactor", {1, 1, 0.5}},
                  {"specularTexture", info(0)},
                  {"specularColorTexture", info(1)}}},
                {"KHR_materials_ior", {{"ior", 1.4}}},
                {"KHR_materials_emissive_strength", {{"emissiveStrength", 5}}},
                {"KHR_materials_transmission",
                 {{"transmissionFactor", 0.5}, {"transmissionTexture", info(0)}}},
                {"KHR_materials_volume",
                 {{"thicknessFactor", 1},
                  {"attenuationDistance", 2},
                  {"attenuationColor", {0.5, 0.25, 1}}}}}}});
  b.node({{"mesh", b.mesh({{"attributes", at}, {"mode", 5}, {"material", 0}})},
          {"scale", {-2, 1, 1}}});
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 3}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}},
      {{"type", "directional"}, {"intensity", 2}}};
  for (int light : {0, 1, 2})
    b.node({{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
  b.json["extensions"]["EXT_lights_area"]["lights"] = {
      {{"type", "rect"}, {"intensity", 3}, {"size", 2}, {"rect", {{"aspect", 0.5}}}},
      {{"type", "disk"}, {"color", {1, 0.5, 0}}}};
  for (int light : {0, 1})
    b.node({{"scale", {1, -2, 1}}, {"extensions", {{"EXT_lights_area", {{"light", light}}}}}});
  return b;
}

/// A scene with skinned, morphed, animated and instanced meshes.
GlbBuilder moving() {
  GlbBuilder b;
  const int p = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.25f}, 3);
  const int n = b.floats({0, 0, 1, 0.6f, 0, 0.8f, 0, 0.6f, 0.8f, 0, 0, 1}, 3);
  const int joints =
      b.accessor(b.view(std::string("\0\1\0\0\1\0\0\0\0\1\1\0\0\0\0\1", 16)), 5121, "VEC4", 4);
  const int weights = b.floats({1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0, 1, 0, 0, 0.25f, 0, 0, 0.75f}, 4);
  const std::vector<float> identities = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,
                                         1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1};
  const int matrices = b.accessor(
      b.view(std::string(reinterpret_cast<const char*>(identities.data()), 128)), 5126, "MAT4", 2);
  b.material(lambert(0.5, 0.5, 0.5));
  nlohmann::ordered_json bent = {
      {"attributes",
       {{"POSITION", p}, {"NORMAL", n}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}},
      {"mode", 5},
      {"material", 0},
      {"targets", {{{"POSITION", n}, {"NORMAL", p}}, {{"POSITION", p}}}}};
  const int mesh = b.mesh(bent);
  b.json["meshes"][0]["weights"] = {0.5, 0.25};
  b.node({{"mesh", mesh}, {"skin", 0}, {"weights", {0.25, 1}}});
  b.json["nodes"].push_back({{"translation", {0, 0, 1}}});
  b.node({{"rotation", {0, 0, 0.6, 0.8}}, {"children", {1}}});
  b.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", matrices}}};
  b.node({{"mesh", mesh},
          {"extensions",
           {{"EXT_mesh_gpu_instancing",
             {{"attributes",
               {{"TRANSLATION", b.floats({1, 2, 3, 4, 5, 6}, 3)},
                {"ROTATION", b.floats({0, 0, 0, 1, 1, 0, 0, 0}, 4)},
                {"SCALE", b.floats({1, 1, 1, 2, -1, 3}, 3)}}}}},
            {"KHR_node_visibility", {{"visible", true}}}}}});
  const int times = b.floats({0, 1}, 1);
  const auto channel = [](int sampler, int node, const char* path) {
    return nlohmann::ordered_json{{"sampler", sampler},
                                  {"target", {{"node", node}, {"path", path}}}};
  };
  b.json["animations"] = {{{"channels",
                            {channel(0, 2, "rotation"), channel(1, 3, "translation"),
                             channel(2, 0, "weights"), channel(1, 3, "scale")}},
                           {"samplers",
                            {{{"input", times}, {"output", b.floats({0, 0, 1, 0, 0, 0, 0, 1}, 4)}},
                             {{"input", times}, {"output", b.floats({1, 1, 2, 3, 4, 5}, 3)}},
                             {{"input", times},
                              {"output", b.floats({0, 0, 0.5f, 1, 0, 0, 0, 0, 0.25f, 1, 0, 0}, 1)},
                              {"interpolation", "CUBICSPLINE"}}}}}};
  return b;
}

/// Between keys, if there are any.
const Pose kBetween{0.4};

/// Everything that was read can be looked up, and all values are finite.
void expect_sound(const Scene& scene) {
  EXPECT_EQ(fault_of(scene), "");
}

/// Replaces every number in the scene's JSON by extremes; what can be read must be valid.
void spoil_every_number(const GlbBuilder& b, int least) {
  const TempFolder folder;
  const std::string whole = b.glb(), text = whole.substr(20, get_json_size(whole));
  const Scene unspoilt = read_gltf(folder.write("rich.glb", whole), kBetween);
  expect_sound(unspoilt);
  const auto numbers = numbers_in(text);
  const std::vector<std::string> extremes = {
      "-1",      "0",      "1",          "3",
      "255",     "65536",  "2147483647", "5121",
      "0.999",   "1e30",   "1e300",      "-1e300",
      "-1e-300", "1e-300", "null",       "18446744073709551615"};
  int loaded = 0, refused = 0;
  for (size_t i = 0; i < numbers.size(); ++i)
    for (size_t k = i % 3; k < extremes.size(); k += 3) {
      const auto [at, length] = numbers[i];
      const std::string& extreme = extremes[k];
      std::string mutant = text;
      mutant.replace(at, length, extreme);
      try {
        const Scene scene = read_gltf(folder.write("mutant.glb", glb_of(mutant, b.bin)), kBetween);
        ++loaded;
        expect_sound(scene);
      } catch (const Error& e) {
        ++refused;
        EXPECT_EQ(std::string(e.what()).find_first_of("\r\n"), std::string::npos) << mutant;
      }
      if (::testing::Test::HasFailure()) FAIL() << extreme << " at " << at << " of " << text;
    }
  EXPECT_GT(loaded, least);
  EXPECT_GT(refused, least);
}

TEST(Mutations, ExtremeNumbersInEveryFieldOfARichScene) {
  const Scene unspoilt = load(rich());
  EXPECT_EQ(needs_of(unspoilt).size(), 10u);  // all that there are
  EXPECT_EQ(unspoilt.warnings, std::vector<std::string>{});
  spoil_every_number(rich(), 200);
}

TEST(Mutations, ExtremeNumbersInEveryFieldOfAMovingScene) {
  const Scene unspoilt = load(moving());
  EXPECT_EQ(unspoilt.triangles.size(), 6u);
  EXPECT_EQ(
      unspoilt.warnings,
      (std::vector<std::string>{
          "the scene stands as its animations begin; they last 1 s: --at takes another time"}));
  spoil_every_number(moving(), 100);
}

/// `from`: the first byte that may change.
void spoil_the_buffer(const GlbBuilder& b, size_t from, int least) {
  const TempFolder folder;
  const std::string whole = b.glb(), text = whole.substr(20, get_json_size(whole));
  int loaded = 0;
  for (uint64_t i = 0; i < 1000; ++i) {
    Rng rng(22, 0, i);
    std::string bin = b.bin;
    // A float with all bits set is NaN; the positions, which come first, must not contain it.
    for (uint32_t k = 1 + rng.below(4); k > 0; --k) {
      const size_t at = from + rng.below(static_cast<uint32_t>(bin.size() - from - 4));
      const char byte = rng.below(3) == 0 ? '\xff' : static_cast<char>(rng.below(256));
      bin.replace(at, 4, 4, byte);
    }
    try {
      const Scene scene = read_gltf(folder.write("mutant.glb", glb_of(text, bin)), kBetween);
      ++loaded;
      expect_sound(scene);
    } catch (const Error&) {
    }
    if (::testing::Test::HasFailure()) FAIL() << i;
  }
  EXPECT_GT(loaded, least);
}

TEST(Mutations, AnyBytesInTheBuffersOfARichScene) {
  spoil_the_buffer(rich(), 48, 500);
}

TEST(Mutations, AnyBytesInTheBuffersOfAMovingScene) {
  spoil_the_buffer(moving(), 48, 100);
}

/// Corrupts data that a library decodes: they are refused, or what was read is valid.
void expect_reads_of(const GlbBuilder& b, uint64_t seed, int least) {
  const TempFolder folder;
  const std::string whole = b.glb(), text = whole.substr(20, get_json_size(whole));
  expect_sound(read_gltf(folder.write("whole.glb", whole)));
  int loaded = 0, refused = 0;
  for (uint64_t i = 0; i < 500; ++i) {
    Rng rng(seed, 0, i);
    std::string bin = b.bin;
    for (uint32_t k = 1 + rng.below(3); k > 0; --k) {
      const size_t at = rng.below(static_cast<uint32_t>(bin.size()));
      const uint32_t what = rng.below(3), bit = rng.below(8), byte = rng.below(256);
      bin[at] = static_cast<char>(what == 0 ? 255 : what == 1 ? byte : bin[at] ^ (1u << bit));
    }
    try {
      expect_sound(read_gltf(folder.write("mutant.glb", glb_of(text, bin))));
      ++loaded;
    } catch (const Error& e) {
      ++refused;
      EXPECT_EQ(std::string(e.what()).find_first_of("\r\n"), std::string::npos) << i;
    }
    if (::testing::Test::HasFailure()) FAIL() << i;
  }
  EXPECT_GT(loaded, least);
  EXPECT_GT(refused, least);
}

TEST(Mutations, AnyBytesInWhatIsCompressed) {
  expect_reads_of(square_by_draco(), 23, 30);
  expect_reads_of(square_by_meshopt(), 24, 30);
}

TEST(Mutations, AnyBytesInAWebP) {
  const std::string whole = texels_by_webp();
  ASSERT_TRUE(gltf::decode_image(whole));
  int decoded = 0;
  for (uint64_t i = 0; i < 2000; ++i) {
    Rng rng(25, 0, i);
    std::string bytes = whole;
    for (uint32_t k = 1 + rng.below(3); k > 0; --k) {
      const size_t at = rng.below(static_cast<uint32_t>(bytes.size()));
      bytes[at] = static_cast<char>(rng.below(256));
    }
    if (rng.below(4) == 0) bytes.resize(rng.below(static_cast<uint32_t>(bytes.size())));
    const auto texels = gltf::texels_declared(bytes);
    if (!texels) continue;
    ASSERT_LE(*texels, 1 << 24);
    if (*texels > 1 << 16) continue;  // takes long
    const auto image = gltf::decode_image(bytes);
    if (!image) continue;
    ++decoded;
    ASSERT_EQ(image->texels.size(), static_cast<size_t>(4 * *texels));
  }
  EXPECT_GT(decoded, 20);
}

TEST(Mutations, EveryTruncationIsRefused) {
  const TempFolder folder;
  const std::string whole = read_file(kTestdata + "/scenes/furnace.glb");
  for (size_t n = 0; n < whole.size(); n += 7)
    EXPECT_THROW(read_gltf(folder.write("short.glb", whole.substr(0, n))), InputError) << n;
}

}  // namespace tdpt::testing::mutations_test
