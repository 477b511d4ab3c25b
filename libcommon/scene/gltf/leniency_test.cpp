// Deviations that every viewer accepts: the scene equals that of the correct file, and a warning is
// is given. Twins: the same error is fatal where it matters.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <functional>

#include "libcommon/base/error.h"
#include "libcommon/testing/scenes/materials.h"

namespace tdpt::testing::leniency_test {

/// A square with a camera: accessors 0 and 1, mesh 0, material 0, nodes 0 and 1, view 0 and 1.
GlbBuilder square() {
  GlbBuilder b;
  const int p = b.floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
  const int i = b.indices_u16({0, 1, 2, 0, 2, 3});
  b.material(lambert(0.5, 0.5, 0.5));
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}, {"indices", i}, {"material", 0}})}});
  b.camera("camera", {0.5, 0.5, 2}, {0.5, 0.5, 0}, 1, 1);
  return b;
}

Scene read(const std::string& bytes) {
  const TempFolder folder;
  return read_gltf(folder.write("scene.glb", bytes));
}

/// Expects `bytes` to be the square; returns the warnings.
Sentences told_of_square(const std::string& bytes) {
  const Scene scene = read(bytes), right = read(square().glb());
  EXPECT_EQ(scene.positions, right.positions);
  EXPECT_EQ(scene.triangles.size(), right.triangles.size());
  EXPECT_EQ(scene.cameras.size(), right.cameras.size());
  EXPECT_EQ(right.warnings, Sentences{});
  return scene.warnings;
}
/// Adds the buffer that glb() would write.
GlbBuilder with_buffer(GlbBuilder b) {
  b.json["buffers"] = Json::array({{{"byteLength", b.bin.size()}}});
  return b;
}
std::string glb_as_it_is(const GlbBuilder& b) {
  return glb_of(b.json.dump(), b.bin);
}
Sentences told(const std::function<void(GlbBuilder&)>& spoil) {
  GlbBuilder b = square();
  spoil(b);
  if (!b.json.contains("buffers")) b = with_buffer(b);
  return told_of_square(glb_as_it_is(b));
}

void set_u32(std::string& bytes, size_t at, size_t value) {
  for (size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>((value >> (8 * i)) & 255);
}

std::string refusal(const GlbBuilder& b) {
  try {
    read(b.json.contains("buffers") ? glb_as_it_is(b) : b.glb());
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(Leniency, BytesBehindTheFilesOwn) {
  const std::string whole = square().glb();
  EXPECT_EQ(told_of_square(whole + "more"), Sentences{});
}

TEST(Leniency, ChunksBehindTheBinaryOne) {
  std::string bytes = square().glb() + std::string("\xff\xff\0\0", 4);  // no chunk at all
  set_u32(bytes, 8, bytes.size());
  EXPECT_EQ(told_of_square(bytes), Sentences{});
}

TEST(Leniency, ChunksThatAreNotFilledUp) {
  const GlbBuilder b = with_buffer(square());
  std::string json = b.json.dump();
  while (json.size() % 4 != 1) json += ' ';
  std::string out("glTF\2\0\0\0\0\0\0\0", 12);
  const auto chunk = [&](const std::string& content, uint32_t type) {
    const size_t at = out.size();
    out += std::string(8, '\0') + content;
    set_u32(out, at, content.size());
    set_u32(out, at + 4, type);
  };
  chunk(json, 0x4E4F534A);
  chunk(b.bin, 0x004E4942);
  set_u32(out, 8, out.size());
  EXPECT_EQ(told_of_square(out), Sentences{});
}

TEST(Leniency, JsonFilledUpByZeros) {
  const GlbBuilder b = with_buffer(square());
  std::string json = b.json.dump();
  EXPECT_EQ(told_of_square(glb_of(json + std::string(4 + (4 - json.size() % 4) % 4, '\0'), b.bin)),
            Sentences{});
}

TEST(Leniency, RootsThatAreChildren) {
  GlbBuilder b = square();  // the camera's node is a root and holds the square's
  b.json["nodes"][1]["children"] = {0};
  const Scene scene = load(b);
  b.json["scenes"][0]["nodes"] = {1};
  const Scene below = load(b);
  EXPECT_EQ(scene.positions, below.positions);
  EXPECT_EQ(scene.triangles.size(), 2u);
  EXPECT_EQ(told([](GlbBuilder& c) { c.json["scenes"][0]["nodes"] = {0, 0, 1}; }), Sentences{});
}

TEST(Leniency, CamerasAndLampsWithoutDirection) {
  GlbBuilder b = square();
  b.camera("flat", {0.5, 0.5, 2}, {0.5, 0.5, 0}, 1, 1);
  b.json["nodes"][2]["scale"] = {0, 0, 0};
  b.json["extensionsUsed"] = {"KHR_lights_punctual"};
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = Json::array({{{"type", "spot"}}});
  b.node({{"scale", {1, 1, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  EXPECT_EQ(told_of_square(b.glb()),
            (Sentences{"cameras with a flat transform are left out: nodes[2]",
                       "lights with a flat transform are left out: nodes[3]"}));
}

// The twin: a fault is a fault, whatever uses it.
TEST(Leniency, FaultsInWhatNothingUsesAreErrors) {
  using Spoil = std::function<void(GlbBuilder&)>;
  const std::vector<std::pair<Spoil, std::string>> cases = {
      {[](GlbBuilder& b) {
         b.json["accessors"].push_back({{"componentType", 5126}, {"count", 0}, {"type", "VEC3"}});
       },
       "accessors[2].count: is 0, expected an integer from 1 to 9007199254740992"},
      {[](GlbBuilder& b) {
         b.json["bufferViews"].push_back({{"buffer", 4}, {"byteLength", 4}});
       },
       "bufferViews[2].buffer: is 4, expected an index into the 1 buffers"},
      {[](GlbBuilder& b) {
         b = with_buffer(b);
         b.json["buffers"].push_back(Json{{"byteLength", 0}});
       },
       "buffers[1].byteLength: is 0, expected an integer from 1 to 9007199254740992"},
      {[](GlbBuilder& b) {
         b.material({{"alphaMode", "GLASS"}});
       },
       "materials[1].alphaMode: is \"GLASS\", expected OPAQUE, MASK or BLEND"},
      {[](GlbBuilder& b) {
         b.json["textures"] = {{{"source", 3}}};
       },
       "textures[0].source: is 3, expected an index into the 0 images"},
      {[](GlbBuilder& b) {
         b.json["images"] = {{{"uri", 3}}};
       },
       "images[0].uri: is 3, expected a string"},
      {[](GlbBuilder& b) {
         b.json["samplers"] = {{{"wrapS", 3}}};
       },
       "samplers[0].wrapS: is 3, expected 10497 (repeat), 33648 (mirrored repeat) or 33071 (clamp "
       "to edge)"},
      {[](GlbBuilder& b) {
         b.json["cameras"].push_back({{"type", "fisheye"}});
       },
       "cameras[1].type: is \"fisheye\", expected perspective or orthographic"},
      {[](GlbBuilder& b) {
         b.json["meshes"].push_back({{"name", "empty"}});
       },
       "meshes[1].primitives: is missing"},
      {[](GlbBuilder& b) {
         b.json["skins"] = {{{"joints", Json::array()}}};
       },
       "skins[0].joints: is missing or empty, expected at least one joint"},
      {[](GlbBuilder& b) {
         b.json["nodes"].push_back({{"mesh", 9}});
       },
       "nodes[2].mesh: is 9, expected an index into the 1 meshes"},
      {[](GlbBuilder& b) {
         b.json["scenes"].push_back({{"nodes", {9}}});
       },
       "scenes[1].nodes[0]: is 9, expected an index into the 2 nodes"},
      {[](GlbBuilder& b) {
         b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "neon"}}};
       },
       "extensions.KHR_lights_punctual.lights[0].type: is \"neon\", expected point, spot or "
       "directional"},
      {[](GlbBuilder& b) {
         b.json["nodes"].push_back({{"name", 7}});
       },
       "nodes[2].name: is 7, expected a string"},
      {[](GlbBuilder& b) {
         b.json["nodes"][1]["rotation"] = {0, 0, 0, 0};
       },
       "nodes[1].rotation: is zero, expected a unit quaternion"},
      {[](GlbBuilder& b) {
         b.json["materials"][0]["extensions"]["KHR_materials_iridescence"]["iridescenceFactor"] =
             "x";
       },
       "materials[0].extensions.KHR_materials_iridescence.iridescenceFactor: is \"x\", expected a "
       "number"},
      {[](GlbBuilder& b) {
         Json lines = {{"mode", 1}, {"attributes", {{"POSITION", 9}}}};
         b.json["meshes"][0]["primitives"].push_back(lines);
       },
       "meshes[0].primitives[1].attributes.POSITION: is 9, expected an index into the 2 accessors"},
      {[](GlbBuilder& b) { b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 9; },
       "meshes[0].primitives[0].attributes.NORMAL: is 9, expected an index into the 2 accessors"}};
  for (const auto& [spoil, fault] : cases) {
    GlbBuilder b = square();
    spoil(b);
    if (!b.json.contains("buffers")) b = with_buffer(b);
    EXPECT_NE(refusal(b).find(".glb:" + fault), std::string::npos) << fault << refusal(b);
  }
}

// The format says that an accessor without a bufferView holds zeros.
TEST(Leniency, IndicesWithoutABufferView) {
  EXPECT_EQ(
      told([](GlbBuilder& b) {
        const int zeros = static_cast<int>(b.json["accessors"].size());
        b.json["accessors"].push_back({{"componentType", 5123}, {"count", 3}, {"type", "SCALAR"}});
        Json primitive = b.json["meshes"][0]["primitives"][0];
        primitive["indices"] = zeros;
        b.mesh(primitive);
      }),
      Sentences{});
}

TEST(Leniency, CornersThatMakeNoTriangle) {
  const auto expected = [](int primitive) {
    return Sentences{fmt::format(
        "corners that make no triangle are left out: meshes[0].primitives[{}]", primitive)};
  };
  EXPECT_EQ(told([](GlbBuilder& b) {
              b.json["accessors"][1]["count"] = 8;
              b.json["bufferViews"][1]["byteLength"] = 16;
              b.bin.resize(48);
              b.indices_u16({0, 1, 2, 0, 2, 3, 0, 1});
              b.json["accessors"].erase(2), b.json["bufferViews"].erase(2);
            }),
            expected(0));
  EXPECT_EQ(told([](GlbBuilder& b) {
              Json strip = b.json["meshes"][0]["primitives"][0];
              strip["indices"] = b.indices_u16({0, 1}), strip["mode"] = 5;
              b.json["meshes"][0]["primitives"].push_back(strip);
            }),
            expected(1));
}

TEST(Leniency, PrimitivesWithoutPositions) {
  EXPECT_EQ(told([](GlbBuilder& b) {
              b.json["meshes"][0]["primitives"].push_back({{"attributes", Json::object()}});
            }),
            Sentences{"primitives without POSITION are left out: meshes[0].primitives[1]"});
}

Json& first_primitive(GlbBuilder& b) {
  return b.json["meshes"][0]["primitives"][0];
}

TEST(Leniency, JointsOutsideOfTheSceneCount) {
  GlbBuilder b = square();
  Json& attributes = first_primitive(b)["attributes"];
  const std::vector<float> one = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  attributes["JOINTS_0"] = b.accessor(b.view(std::string(16, '\0')), 5121, "VEC4", 4);
  attributes["WEIGHTS_0"] = b.floats(one, 4);
  b.json["nodes"][0]["skin"] = 0;
  b.json["nodes"].push_back({{"scale", {1, 2, 1}}});
  b.json["skins"] = {{{"joints", {2}}}};
  const Scene s = read(b.glb());
  EXPECT_NEAR(s.positions[2].y - s.positions[1].y, 2 * (s.positions[1].x - s.positions[0].x), 1e-6);
  b.json["nodes"][2]["scale"] = 1;
  EXPECT_NE(refusal(b).find("nodes[2].scale: is 1"), std::string::npos);
}

TEST(Leniency, AttributesThatAreNotReadMayBeAnything) {
  EXPECT_EQ(told([](GlbBuilder& b) {
              first_primitive(b)["attributes"]["_X"] = 9;
              first_primitive(b)["attributes"]["TEXCOORD_7"] = "x";
              first_primitive(b)["targets"] = {{{"_X", 9}}};
            }),
            Sentences{});
}

TEST(Leniency, ExtensionsThatAreNotReadMayBeUsedButNotRequired) {
  EXPECT_EQ(told([&](GlbBuilder& b) { b.json["extensionsUsed"] = {"KHR_lights_environment"}; }),
            Sentences{});
  GlbBuilder b = square();
  b.json["extensionsRequired"] = {"KHR_lights_environment"};
  EXPECT_NE(refusal(b).find("\"KHR_lights_environment\" is not supported"), std::string::npos);
}

}  // namespace tdpt::testing::leniency_test
