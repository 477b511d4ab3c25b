// Malformed files are refused with the place of their fault, and none crashes the reader: every
// field of a scene that has them all, with every wrong type and with extreme values; a table of
// faults that a value alone does not show; damaged bytes; and what lies beside the file.
#include <gtest/gtest.h>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <regex>
#include <sstream>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/math/rng.h"
#include "libcommon/testing/files/ies_text.h"
#include "libcommon/testing/files/sound_scene.h"
#include "libcommon/testing/rooms/squares.h"
#include "libcommon/testing/scenes/materials.h"
#include "libcommon/testing/scenes/needs.h"

namespace tdpt::testing::malformed_test {

namespace fs = std::filesystem;
using Pointer = Json::json_pointer;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A scene whose JSON, buffers and all, can be damaged.
struct Document {
  Json json;
  std::string bin;

  explicit Document(const GlbBuilder& b) : json(b.document()), bin(b.bin) {}
  std::string glb() const { return glb_of(json.dump(), bin); }
};

/// Its accessors, by number. From 17 on they are there for faults, which refer to them.
void add_accessors(GlbBuilder& b) {
  const std::vector<float> bent = {0, 0, 1, 0.6f, 0, 0.8f, 0, 0.6f, 0.8f, 0, 0, 1};
  b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.25f}, 3);                    // 0: positions
  b.floats(bent, 3);                                                        // 1: normals
  b.floats({1, 0, 0, 1, 1, 0, 0, -1, 1, 0, 0, 1, 1, 0, 0, 1}, 4);           // 2: tangents
  b.floats({0, 0, 1, 0, 0, 1, 1, 1}, 2);                                    // 3: TEXCOORD_0, sparse
  b.accessor(b.view(std::string(16, '\1'), 4), 5120, "VEC2", 4);            // 4: TEXCOORD_1
  b.floats({1, 0, 0, 1, 0, 1, 0, 0.5f, 0, 0, 1, 1, 1, 1, 1, 1}, 4);         // 5: colours
  b.indices_u16({0, 1, 2, 3});                                              // 6: a strip
  b.accessor(b.view(std::string("\0\1\0\0\1\0\0\0\0\1\1\0\0\0\0\1", 16)),   // 7: joints
             5121, "VEC4", 4);                                              //
  b.floats({1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0, 1, 0, 0, 0.25f, 0, 0, 1}, 4);  // 8: weights
  const std::vector<float> binds = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,
                                    1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1};
  b.accessor(b.view(bytes_of(binds)), 5126, "MAT4", 2);              // 9: inverse binds
  b.floats({1, 2, 3, 4, 5, 6}, 3);                                   // 10: of instances
  b.floats({0, 0, 0, 1, 1, 0, 0, 0}, 4);                             // 11
  b.floats({1, 1, 1, 2, -1, 3}, 3);                                  // 12
  b.floats({0, 1}, 1);                                               // 13: times of keys
  b.floats({0, 0, 1, 0, 0, 0, 0, 1}, 4);                             // 14: rotations
  b.floats({1, 1, 2, 3, 4, 5}, 3);                                   // 15: translations
  b.floats({0, 0, 0.5f, 1, 0, 0, 0, 0, 0.25f, 1, 0, 0}, 1);          // 16: a spline's keys
  b.floats({1, 0, 0, 0, 1, 0, 0, kNan, 1, 0, 0, 0, 1, 0, 0, 0}, 4);  // 17
  b.floats(std::vector<float>(16), 4);                               // 18
  b.floats({1, 1, 1}, 3);                                            // 19
  b.floats(std::vector<float>(8), 2);                                // 20
  b.accessor(b.view(std::string(16, '\1')), 5122, "VEC4", 2);        // 21: not normalized
  b.floats({0, 2, 1}, 1);                                            // 22: back in time
  b.floats({0, 0, 0, kNan, 0, 0, 0, 1, 0, 1, 1, 0.25f}, 3);          // 23
  b.indices_u16({0, 1, 9});                                          // 24
  b.floats({0, 0, 0, 1e30f, 0, 0, 0, 1, 0, 1, 1, 0.25f}, 3);         // 25
  b.accessor(b.view(std::string(44, '\0')), 5126, "VEC3", 4);        // 26: a byte too few
  b.accessor(b.view(std::string(32, '\5')), 5121, "VEC4", 4);        // 27: joints
  const int index = b.view(std::string("\0\3", 2)), value = b.view(std::string(16, '\x3f'));
  b.json["accessors"][3]["sparse"] = {{"count", 2},
                                      {"indices", {{"bufferView", index}, {"componentType", 5121}}},
                                      {"values", {{"bufferView", value}}}};
  for (Json& a : b.json["accessors"]) a.erase("min"), a.erase("max");  // not read
  for (Json& v : b.json["bufferViews"]) v.erase("target");
}

/// The rest of a scene with every attribute, map, extension and kind of light, skins, targets and
/// animations. @PNG and @BUMP stand for references to a texture.
const std::string kEverything = R"({
  "scenes": [{"nodes": [0, 1, 3, 4, 5, 6, 7, 8], "extras": {
    "tdpt_environment": "1,2,3", "tdpt_environment_rotation": 20, "tdpt_environment_scale": 2,
    "tdpt_width": 40, "tdpt_height": 30, "tdpt_camera": "eye"}}],
  "nodes": [
    {"name": "sheet", "mesh": 0, "scale": [-2, 1, 1]},
    {"mesh": 1, "skin": 0, "weights": [0.25, 1]},
    {"translation": [0, 0, 1]},
    {"rotation": [0, 0, 0.6, 0.8], "children": [2]},
    {"mesh": 1, "extensions": {
      "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 10, "ROTATION": 11, "SCALE": 12}},
      "KHR_node_visibility": {"visible": true}}},
    {"camera": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 2, 9, 1]},
    {"extensions": {"KHR_lights_punctual": {"light": 0}, "EXT_lights_area": {"light": 0}}},
    {"extensions": {"KHR_lights_punctual": {"light": 1}, "EXT_lights_area": {"light": 1}}},
    {"extensions": {"KHR_lights_punctual": {"light": 2},
                    "EXT_lights_ies": {"light": 0, "multiplier": 2, "color": [1, 0.5, 0]}}}],
  "meshes": [
    {"name": "sheet", "primitives": [{"material": 0, "mode": 5, "indices": 6, "attributes": {
      "POSITION": 0, "NORMAL": 1, "TANGENT": 2, "TEXCOORD_0": 3, "TEXCOORD_1": 4, "COLOR_0": 5}}]},
    {"weights": [0.5, 0.25], "primitives": [{"material": 1, "mode": 5,
      "attributes": {"POSITION": 0, "NORMAL": 1, "JOINTS_0": 7, "WEIGHTS_0": 8},
      "targets": [{"POSITION": 1, "NORMAL": 0}, {"POSITION": 0}]}]}],
  "skins": [{"joints": [2, 3], "inverseBindMatrices": 9}],
  "cameras": [
    {"name": "eye", "type": "perspective", "perspective": {"yfov": 0.7, "aspectRatio": 1.5}}],
  "animations": [{"name": "walk",
    "channels": [{"sampler": 0, "target": {"node": 3, "path": "rotation"}},
                 {"sampler": 1, "target": {"node": 2, "path": "translation"}},
                 {"sampler": 1, "target": {"node": 2, "path": "scale"}},
                 {"sampler": 2, "target": {"node": 1, "path": "weights"}}],
    "samplers": [{"input": 13, "output": 14}, {"input": 13, "output": 15},
                 {"input": 13, "output": 16, "interpolation": "CUBICSPLINE"}]}],
  "extensions": {
    "KHR_lights_punctual": {"lights": [
      {"type": "point", "name": "bulb", "color": [1, 0.5, 0], "intensity": 3},
      {"type": "spot", "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}},
      {"type": "directional", "intensity": 2}]},
    "EXT_lights_area": {"lights": [
      {"type": "rect", "intensity": 3, "size": 2, "rect": {"aspect": 0.5}},
      {"type": "disk", "name": "disk", "color": [1, 0.5, 0]}]},
    "EXT_lights_ies": {"lights": [{"name": "lamp", "uri": ""}]}},
  "extensionsRequired": ["KHR_mesh_quantization"],
  "materials": [
    {"name": "all", "alphaMode": "BLEND", "alphaCutoff": 0.25, "doubleSided": true,
     "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 0.5], "metallicFactor": 0.5,
       "roughnessFactor": 0.5, "baseColorTexture": @PNG, "metallicRoughnessTexture": @PNG},
     "normalTexture": @BUMP, "emissiveFactor": [1, 2, 3], "emissiveTexture": {"index": 1},
     "extensions": {
       "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1, 1, 0.5],
         "specularTexture": @PNG, "specularColorTexture": @PNG},
       "KHR_materials_ior": {"ior": 1.4},
       "KHR_materials_emissive_strength": {"emissiveStrength": 5},
       "KHR_materials_transmission": {"transmissionFactor": 0.5, "transmissionTexture": @PNG},
       "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2,
         "attenuationColor": [0.5, 0.25, 1]},
       "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.5,
         "clearcoatTexture": @PNG, "clearcoatRoughnessTexture": @PNG,
         "clearcoatNormalTexture": @BUMP},
       "KHR_materials_sheen": {"sheenColorFactor": [0.5, 0.25, 1], "sheenRoughnessFactor": 0.5,
         "sheenColorTexture": @PNG, "sheenRoughnessTexture": @PNG},
       "KHR_materials_iridescence": {"iridescenceFactor": 0}}},
    {"extras": {"tdpt_eta": [0.1, 0.4, 4], "tdpt_k": [4, 2, 3]}},
    {"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.5, 0.25, 1, 1],
      "specularFactor": [0.25, 0.5, 0.125], "glossinessFactor": 0.75, "diffuseTexture": @PNG,
      "specularGlossinessTexture": @PNG}}}]
})";

GlbBuilder everything() {
  GlbBuilder b;
  add_accessors(b);
  b.texture(png_of(2, 2, "abcdefghijklmnop"),
            {{"wrapS", 33648}, {"wrapT", 33071}, {"magFilter", 9728}});
  const int webp = b.view(texels_by_webp());
  b.json["images"].push_back({{"bufferView", webp}, {"mimeType", "image/webp"}});
  b.json["textures"].push_back({{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}});
  const std::string info = R"("index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform":
    {"offset": [1, 2], "rotation": 3, "scale": [4, 5], "texCoord": 0}}})";
  std::string text = std::regex_replace(kEverything, std::regex("@PNG"), "{" + info);
  text = std::regex_replace(text, std::regex("@BUMP"), R"({"scale": 0.5, )" + info);
  b.json.update(Json::parse(text));
  const IesText profile{.vertical = {0, 90}, .candela = {10, 4}};
  b.json["extensions"]["EXT_lights_ies"]["lights"][0]["uri"] =
      "data:;base64," + base64(profile.text());
  return b;
}

const Pose kBetween{0.4};  // keys, if there are any

std::string read_in(const TempFolder& folder, const std::string& bytes, Scene* out = nullptr) {
  const std::string path = folder.write("scene.glb", bytes);
  try {
    Scene scene = read_gltf(path, kBetween);
    if (!scene.cameras.empty()) scene.camera("");
    if (out) *out = std::move(scene);
  } catch (const Error& e) {
    const std::string what = e.what();
    EXPECT_EQ(e.code, Exit::bad_input) << what;
    EXPECT_EQ(what.find_first_of("\r\n"), what.npos) << what;
    EXPECT_TRUE(what.starts_with(path + ":")) << what;
    return what.substr(std::min(path.size() + 1, what.size()));
  }
  return "";
}

/// The error of a scene or of its first camera, without the file's name; "" if there is none.
std::string refusal(const std::string& bytes) {
  const TempFolder folder;
  return read_in(folder, bytes);
}

/// Every value below the root.
void collect(const Json& value, const Pointer& at, std::vector<Pointer>& out) {
  const auto below = [&](const Json& v, const Pointer& p) {
    out.push_back(p);
    collect(v, p, out);
  };
  if (value.is_object())
    for (const auto& [name, v] : value.items()) below(v, at / name);
  if (value.is_array())
    for (size_t i = 0; i < value.size(); ++i) below(value[i], at / i);
}

std::vector<Pointer> fields_of(const Json& json) {
  std::vector<Pointer> out;
  collect(json, Pointer(), out);
  return out;
}

/// As messages write it: "nodes[0].children[1]".
std::string place_of(const Pointer& at) {
  const std::string text = std::regex_replace(at.to_string(), std::regex("/(\\d+)(?=/|$)"), "[$1]");
  return std::regex_replace(text.substr(1), std::regex("/"), ".");
}

Json of_another_type(const Json& value) {
  return value.is_string()   ? Json(7)
         : value.is_array()  ? Json::object()
         : value.is_object() ? Json::array()
                             : Json("x");
}

/// Values that a scene is read without; all others are checked.
bool is_ignored(const std::string& field) {
  static const std::regex kIgnored(".*/(generator|mimeType|znear|extras|target|(min|max)(/\\d)?)");
  return std::regex_match(field, kIgnored);
}

class EveryField : public ::testing::TestWithParam<GlbBuilder (*)()> {
 protected:
  const Document whole_{GetParam()()};
  const TempFolder folder_;
};

TEST_P(EveryField, OfAnotherTypeIsRefusedAtItsPlace) {
  ASSERT_EQ(read_in(folder_, whole_.glb()), "");
  for (const Pointer& at : fields_of(whole_.json)) {
    Document d = whole_;
    d.json[at] = of_another_type(d.json[at]);
    const std::string error = read_in(folder_, d.glb());
    if (is_ignored(at.to_string())) continue;
    EXPECT_TRUE(error.starts_with(place_of(at) + ": is ")) << at << ": " << error;
  }
}

/// A scene that was read is sound; an error names a place of the file, or what all of it is.
void expect_sound_or_refused(const Document& d, const Document& whole, const TempFolder& folder,
                             int& read, int& refused) {
  Scene scene;
  const std::string error = read_in(folder, d.glb(), &scene);
  if (error.empty()) {
    ++read;
    EXPECT_EQ(fault_of(scene), "");
    return;
  }
  ++refused;
  const std::string section = error.substr(0, error.find_first_of("[.: "));
  EXPECT_TRUE(section.empty() || whole.json.contains(section)) << error;
}

TEST_P(EveryField, ThatIsMissingOrExtremeLeavesASoundSceneOrARefusedOne) {
  const std::vector<Json> extremes = {-1,     0,          1,       3,    255,
                                      65536,  2147483647, 0.999,   1e30, 1e300,
                                      -1e300, 1e-300,     nullptr, true, 18446744073709551615u};
  const std::vector<Pointer> fields = fields_of(whole_.json);
  int read = 0, refused = 0;
  for (size_t i = 0; i < fields.size(); ++i) {
    Document missing = whole_;
    Json& owner = missing.json[fields[i].parent_pointer()];
    if (owner.is_array())
      owner.erase(std::stoul(fields[i].back()));
    else
      owner.erase(fields[i].back());
    expect_sound_or_refused(missing, whole_, folder_, read, refused);
    if (whole_.json[fields[i]].is_number())
      for (size_t k = i % 3; k < extremes.size(); k += 3) {  // all of them in three fields
        Document d = whole_;
        d.json[fields[i]] = extremes[k];
        expect_sound_or_refused(d, whole_, folder_, read, refused);
        if (HasFailure()) FAIL() << extremes[k] << " at " << fields[i];
      }
    if (HasFailure()) FAIL() << "without " << fields[i];
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(refused, 50);
}

/// Damage of a few bytes, half of it in the JSON, where digits become digits.
TEST_P(EveryField, AndAnyBytesLeaveASoundSceneOrARefusedOne) {
  const std::string text = whole_.json.dump();
  int read = 0, refused = 0;
  for (uint64_t i = 0; i < 800; ++i) {
    Rng rng(20, 0, i);
    std::string json = text, bin = whole_.bin;
    std::string& bytes = i % 2 == 0 ? json : bin;
    for (uint32_t n = 1 + rng.below(3); n > 0; --n) {
      const size_t at = rng.below(static_cast<uint32_t>(bytes.size()));
      const bool digit = i % 2 == 0 && bytes[at] >= '0' && bytes[at] <= '9';
      const uint32_t any = rng.below(3) == 0 ? 255 : rng.below(256);
      bytes[at] = static_cast<char>(digit ? '0' + any % 10 : any);
    }
    Scene scene;
    (read_in(folder_, glb_of(json, bin), &scene).empty() ? read : refused) += 1;
    EXPECT_EQ(fault_of(scene), "");
    if (HasFailure()) FAIL() << i;
  }
  EXPECT_GT(read, 50);
  EXPECT_GT(refused, 50);
}

INSTANTIATE_TEST_SUITE_P(Malformed, EveryField,
                         ::testing::Values(&everything, &square_by_draco, &square_by_meshopt));

TEST(Malformed, NothingIsMissingFromTheSceneThatIsSpoilt) {
  const Scene scene = load(everything());
  EXPECT_EQ(needs_of(scene).size(), all_needs().size() - 1);  // all but a sky
  EXPECT_EQ(scene.triangles.size(), 2u + 2 + 2 * 2 + 2 + 64);
}

/// A line for each message: the fields that are set, by pointer, and how the error begins. One that
/// begins with "expected", ":" or "," stands behind the place of the first field, and what that is.
const char* const kFaults = R"(
/asset/version = "1.0", /meshes = {} -> expected "2.0"
/extensionsRequired/0 = "ACME" -> extensionsRequired: "ACME" is not supported
/extensionsRequired/0 = "a\nb\u001b[2J" -> extensionsRequired: "a?b?[2J" is not supported
/scene = 1 -> expected an index into the 1 scenes
/nodes/3/children = 2 -> expected an array of indices
/nodes/0/translation = [1, 2] -> : is an array of 2, expected an array of 3 numbers
/nodes/1/weights = 1 -> expected an array of numbers
/nodes/4/extensions/KHR_node_visibility/visible = "no" -> expected true or false
/nodes/0/name = 7 -> expected a string
/materials/0/extensions/KHR_materials_ior = 3 -> expected an object

/accessors/0/count = 3.5 -> expected an integer from 1 to 9007199254740992
/accessors/0/count = "4" -> expected an integer
/accessors/0/componentType = 5124 -> expected 5120, 5121, 5122, 5123, 5125 or 5126 (float)
/accessors/0/type = "VEC5" -> expected SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4
/accessors/0/count = 9007199254740992 -> accessors[0]: 9007199254740992 elements, 12 bytes apart
/accessors/0/byteOffset = 4 -> accessors[0]: 4 elements, 12 bytes apart, from byte 4 reach beyond
/bufferViews/0/byteStride = 8 -> accessors[0]: elements of 12 bytes do not fit the byteStride 8
/bufferViews/0/byteStride = 6 -> expected a multiple of 4
/bufferViews/0/byteOffset = 9007199254740992 -> bufferViews[0]: 48 bytes from byte 9007199254740992
/buffers/0/byteLength = 99999 -> buffers[0]: is cut short: 
/buffers/1 = {"byteLength": 4}, /bufferViews/0/buffer = 1 -> : has neither a uri nor a binary chunk
/accessors/0 = {"componentType": 5126, "count": 4e9, "type": "VEC3"} -> : 4000000000 elements without
/accessors/3/sparse/indices = {"bufferView": 0, "byteOffset": 14, "componentType": 5121} -> : index 128
/accessors/3/sparse/indices/componentType = 5126 -> expected 5121, 5123 or 5125
/accessors/3/sparse/count = 3 -> accessors[3].sparse.indices: 3 elements, 1 bytes apart, from byte 0
/accessors/3/sparse/values/byteOffset = 9 -> accessors[3].sparse.values: 2 elements, 8 bytes apart

/meshes/0/primitives/0/mode = 7 -> expected an integer from 0 to 6
/meshes/0/primitives/0/indices = 20 -> accessors[20].type: indices are not SCALAR
/meshes/0/primitives/0/indices = 13 -> accessors[13].componentType: indices are of type 5126, expected
/meshes/0/primitives/0/indices = 24 -> accessors[24]: index 9 at 2 is out of range, the primitive has 4
/meshes/0/primitives/0/attributes/POSITION = 20 -> accessors[20].type: positions are not VEC3
/meshes/0/primitives/0/attributes/POSITION = 23 -> accessors[23]: element 1 of positions is not finite
/meshes/0/primitives/0/attributes/NORMAL = 19 -> accessors[19]: count is 1, expected at least 4 normals
/meshes/0/primitives/0/attributes/NORMAL = 26 -> accessors[26]: 4 elements, 12 bytes apart
/meshes/0/primitives/0/attributes/TANGENT = 1 -> accessors[1].type: tangents are not VEC4
/meshes/0/primitives/0/attributes/COLOR_0 = 20 -> accessors[20].type: vertex colours are not VEC3 or
/meshes/0/primitives/0/attributes/COLOR_0 = 7 -> accessors[7].componentType: vertex colours are of type
/meshes/1/primitives/0/targets/0/POSITION = 19 -> accessors[19]: count is 1, expected at least 4

/nodes/2/children = [3] -> nodes[2]: is its own ancestor, expected a tree of nodes
/nodes/0/children = [2] -> nodes[2]: is reached twice, from nodes[0] and nodes[3]
/nodes/5/matrix/3 = 1 -> nodes[5].matrix: is not affine, expected a last row of 0 0 0 1
/nodes/2/rotation = [0, 0, 0, 0] -> : is zero, expected a unit quaternion
/nodes/5/matrix/0 = 1e200, /nodes/5/children = [0], /nodes/0/scale/0 = 1e200 -> nodes[0]: its transform and those
/nodes/0/scale/0 = 1e300, /meshes/0/primitives/0/attributes/POSITION = 25 -> nodes[0]: its transform takes a vertex
/nodes/4/extensions/EXT_mesh_gpu_instancing/attributes/SCALE = 19 -> : count is 1, expected 2 as of
/nodes/4/extensions/EXT_mesh_gpu_instancing/attributes = {"ROTATION": 18} -> accessors[18]: rotation 0
/nodes/4/extensions/EXT_mesh_gpu_instancing/attributes/ROTATION = 21 -> accessors[21].componentType:
/skins/0/joints = [] -> : is missing or empty, expected at least one joint
/skins/0/joints = [2, 3, 0] -> accessors[9]: count is 2, expected at least 3 inverse bind matrices
/meshes/1/primitives/0/attributes/JOINTS_0 = 27 -> accessors[27]: joint 5 of vertex 0 is out of range
/meshes/1/primitives/0/attributes/WEIGHTS_0 = 17 -> accessors[17]: element 1 of weights is not finite
/animations/0/channels/0/sampler = 3 -> expected an index into the 3 samplers
/animations/0/samplers/0/input = 22 -> accessors[22]: key 2 lies at 1 s, before key 1 at 2 s, expected
/animations/0/samplers/1/interpolation = "CUBICSPLINE" -> accessors[15]: count is 2, expected at least 6

/cameras/0/perspective/yfov = 3.5 -> expected an angle between 0 and pi
/cameras/0/perspective/aspectRatio = 0 -> expected more than 0
/cameras/0/type = "fisheye" -> expected perspective or orthographic
/nodes/6/extensions/KHR_lights_punctual/light = 3 -> expected an index into the 3 lights
/extensions/KHR_lights_punctual/lights/1/spot = {"innerConeAngle": 0.8} -> : has an inner cone of 0.8
/extensions/KHR_lights_punctual/lights/1/spot = {"outerConeAngle": 1.6} -> : has an inner cone of 0 and
/extensions/EXT_lights_area/lights/1/intensity = 1e31 -> extensions.EXT_lights_area.lights[1]: has an
/extensions/EXT_lights_area/lights/1/size = 1e300, /nodes/7/scale = [1e100, 1, 1] -> nodes[7]: its transform takes an area
/extensions/EXT_lights_ies/lights/0 = {} -> extensions.EXT_lights_ies.lights[0].uri: is missing, a
/extensions/EXT_lights_ies/lights/0 = {"uri": "data:;base64,AAAA"} -> , line 1: is no IES file: no line
/nodes/8/extensions/EXT_lights_ies/multiplier = 1e308 -> nodes[8]: has an intensity of inf, expected
/materials/0/extensions/KHR_materials_ior/ior = 0.5 -> expected 0 or a number from 1 to 1e6
/materials/0/emissiveFactor/1 = -1 -> expected a number of at least 0
/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength = 1e40 -> materials[0]: emits a
/materials/1/extras = {"tdpt_eta": [1, 1, 1]} -> : has tdpt_eta without tdpt_k, expected both or neither
/materials/1/extras/tdpt_eta/1 = 0 -> expected a number from 0.001 to 1000
/materials/2/alphaMode = "GLASS" -> expected OPAQUE, MASK or BLEND
/samplers/0/wrapS = 1 -> expected 10497 (repeat), 33648 (mirrored repeat) or 33071 (clamp to edge)
/samplers/0/magFilter = 9987 -> expected 9728 (nearest) or 9729 (linear)
/images/0 = {"uri": "../picture.png"} -> images[0].uri: "../picture.png" is not a file in the scene's

/scenes/0/extras/tdpt_width = 0 -> expected an integer from 1 to 65536
/scenes/0/extras/tdpt_environment_rotation = 400 -> expected a number from -360 to 360
/scenes/0/extras/tdpt_environment = [1, 2] -> : is an array of 2, expected a file, or R,G,B: three
/scenes/0/extras/tdpt_environment = [1, -2, 3] -> : is "1,-2,3", expected a file, or R,G,B: three
/scenes/0/extras/tdpt_environment = "" -> expected a file, or R,G,B: three numbers from 0 to 1e30
/scenes/0/extras/tdpt_environment = "0,0,0" -> expected a colour that is not black
/scenes/0/extras/tdpt_camera = "cellar" -> : there is no camera "cellar", expected one of "eye"
/scenes/0/nodes = [5] ->  has no triangles in its scene
/scenes/0/nodes = [0], /nodes/0/scale = [0, 0, 0] ->  has no triangle with an area
/nodes/0/scale/0 = 1e40 ->  is 1e+40 m long, expected 1e-30 to 1e+30
)";

const char* const kFaultsOfDraco = R"(
~/attributes/NORMAL = 1 -> meshes[0].primitives[0].attributes.NORMAL: is missing, but is compressed by
~/attributes/POSITION = -1 -> expected an integer from 0 to 4294967295
~/attributes = {} -> ~: has no attribute POSITION
~/attributes/POSITION = 7 -> ~: holds no attribute 7
/accessors/0/type = "VEC2" -> ~: its attribute 0 has other components than its accessor
/accessors/0/count = 1 -> ~: holds 4 vertices, expected at most 2, as POSITION has 1
/accessors/1/count = 1 -> ~: holds 6 corners of triangles, expected at most 3, as the indices are 1
/accessors/0/count = 9007199254740992 -> ~: declares 9007199254740992 vertices and 6 corners of
/bufferViews/0/byteLength = 60 -> ~: cannot be decoded, expected a mesh of Draco, version 2.2 at most
)";

const char* const kFaultsOfMeshoptimizer = R"(
~/mode = "LINES" -> expected ATTRIBUTES, TRIANGLES or INDICES
~/filter = "COLOR" -> expected NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL
~/filter = "OCTAHEDRAL", ~/mode = "INDICES", ~/byteStride = 2 -> expected NONE where there are indices
~/byteStride = 10 -> expected a multiple of 4
~/filter = "OCTAHEDRAL" -> ~.byteStride: is 12, expected 4 or 8 with this filter
~/filter = "QUATERNION" -> ~.byteStride: is 12, expected 8 with this filter
~/mode = "TRIANGLES" -> ~.byteStride: is 12, expected 2 or 4, the bytes of an index
/bufferViews/0/byteStride = 16 -> ~.byteStride: is 12, expected 16 as of the bufferView
~/mode = "TRIANGLES", ~/byteStride = 2 -> ~.count: is 4, expected a multiple of 3
~/byteLength = 80 -> ~: 80 bytes from byte 0 reach beyond buffers[0] of 79 bytes
~/count = 9007199254740992 -> ~: declares 9007199254740992 elements of 12 bytes, expected at most 4288
~/count = 3 -> ~: declares 3 elements of 12 bytes, expected 48 bytes as the bufferView has
~/byteLength = 40 -> ~: cannot be decoded, expected data of meshoptimizer, version 0
)";

/// `tilde`: the pointer that "~" stands for.
void expect_faults(const GlbBuilder& b, const std::string& faults, const std::string& tilde = "") {
  const TempFolder folder;
  const Document whole(b);
  std::istringstream lines(faults);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    const size_t arrow = line.find(" -> ");
    std::string fields = line.substr(0, arrow), says = line.substr(arrow + 4);
    fields = std::regex_replace(fields, std::regex("~"), tilde);
    // As JSON: {"/scene": 1, "/nodes/0/name": 7}.
    fields = std::regex_replace(fields, std::regex("(^|, )(/\\S+) = "), "$1\"$2\": ");
    Document d = whole;
    const Json set = Json::parse("{" + fields + "}");
    for (const auto& [at, value] : set.items()) d.json[Pointer(at)] = value;
    const std::string first = place_of(Pointer(set.begin().key()));
    if (says.starts_with("expected")) says = first + ": is " + set.begin()->dump() + ", " + says;
    if (says.starts_with(':') || says.starts_with(',')) says = first + says;
    if (says.starts_with('~')) says = place_of(Pointer(tilde)) + says.substr(1);
    const std::string error = read_in(folder, d.glb());
    EXPECT_TRUE(error.starts_with(says)) << line << "\nsays " << error;
  }
}

TEST(Malformed, EveryFileIsRefusedWithItsPlaceAndMessage) {
  expect_faults(everything(), kFaults);
  expect_faults(square_by_draco(), kFaultsOfDraco,
                "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression");
  expect_faults(square_by_meshopt(), kFaultsOfMeshoptimizer,
                "/bufferViews/0/extensions/EXT_meshopt_compression");
}

/// With one byte of a compressed square replaced by others.
std::string refusal_with(GlbBuilder b, size_t at, const std::string& bytes) {
  b.bin.replace(at, 1, bytes);
  return refusal(b.glb());
}

TEST(Malformed, IndicesAndCountsOfWhatIsDecodedAreChecked) {
  // Of 2^32 - 1 vertices: Draco allocates them before it reads them.
  EXPECT_NE(refusal_with(square_by_draco(), 12, "\xff\xff\xff\xff\x0f").find("cannot be decoded"),
            std::string::npos);
  EXPECT_EQ(refusal_with(square_by_draco(), 16, "\t"),
            "accessors[1]: index 9 at 2 is out of range, the primitive has 4 vertices");
  EXPECT_EQ(refusal_with(square_by_meshopt(), 70, "\x24"),  // a step of 9
            "accessors[1]: index 9 at 1 is out of range, the primitive has 4 vertices");
  // Two bufferViews of the same compressed zeros.
  GlbBuilder b = square_by_meshopt();
  b.bin = "\xa0" + std::string(512, '\0');
  b.json.merge_patch(Json::parse(R"({
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"}],
    "meshes": [{"primitives": [{"mode": 5, "attributes": {"POSITION": 0}},
                               {"mode": 5, "attributes": {"POSITION": 1}}]}]})"));
  Json& view = b.json["bufferViews"][0];
  view["byteLength"] = 30720;
  view["extensions"]["EXT_meshopt_compression"].update({{"byteLength", 513}, {"count", 2560}});
  b.json["bufferViews"][1] = view;
  EXPECT_EQ(refusal(b.glb()),
            "bufferViews[1].extensions.EXT_meshopt_compression: brings the scene to 61440 bytes, "
            "expected at most 32832 from 513");
}

TEST(Malformed, FilesOfNoSceneSayWhatTheyAre) {
  const std::string whole = square().glb();
  const auto with = [&](size_t at, char byte) {
    return std::string(whole).replace(at, 1, 1, byte);
  };
  const std::string deep(5000, '['), end(5000, ']');
  std::string short_chunk = whole.substr(0, 20 + 4 + static_cast<unsigned char>(whole[12]) +
                                                256 * static_cast<unsigned char>(whole[13]));
  short_chunk[8] = static_cast<char>(short_chunk.size() & 255);
  short_chunk[9] = static_cast<char>(short_chunk.size() >> 8);
  for (const auto& [bytes, says] : std::vector<std::pair<std::string, std::string>>{
           {"", " is empty, expected a glTF 2.0 scene"},
           {"hello\n", " is no glTF scene, expected \"glTF\" (.glb) or \"{\" (.gltf) at its start"},
           {"glTF\2", "header: is cut short after 5 bytes, expected 12"},
           {with(4, 1), "header: version is 1, expected 2"},
           {short_chunk, "chunk[1]: is cut short: 4 bytes, expected a header of 8"},
           {with(14, 1), "chunk[0]: declares "},
           {with(16, 'X'), "chunk[0]: is not JSON, expected the JSON chunk first"},
           {std::string("glTF\2\0\0\0\14\0\0\0", 12), "chunk[0]: is missing or empty"},
           {R"({"asset": {"version": "2.0"}, "nodes": [)", "JSON byte 41: is not valid JSON"},
           {R"({"scene": 1e999})", "JSON: holds a number beyond the range of double precision"},
           {"{\"asset\": " + deep + end + "}", "JSON: is nested more than 64 levels deep"},
           {"{}", "asset: is missing, so this is no glTF scene: "}}) {
    const std::string error = refusal(bytes);
    EXPECT_TRUE(error.starts_with(says)) << error << "\nexpected " << says;
  }
  for (size_t n = 12; n < whole.size(); n += 7) {
    const std::string error = refusal(whole.substr(0, n));
    EXPECT_TRUE(error.starts_with("header: the file is cut short: ")) << n << error;
  }
}

std::string refusal_of_file(const std::string& path) {
  try {
    read_gltf(path);
  } catch (const InputError& e) {
    const std::string what = e.what();
    return what.substr(std::min(path.size() + 1, what.size()));
  }
  return "";
}

TEST(ExternalFiles, LieInTheScenesFolderOrBelow) {
  const TempFolder folder;
  const std::string buffer = square().bin;
  folder.write("scene/parts/room one.bin", buffer);
  folder.write("outside/room.bin", buffer);
  folder.write("README.md", buffer);
  fs::create_symlink("parts/room one.bin", folder.path / "scene/link.bin");
  fs::create_symlink("../outside/room.bin", folder.path / "scene/room.bin");
  fs::create_directory_symlink("../outside", folder.path / "scene/door");
  ASSERT_EQ(std::system(("mkfifo '" + (folder.path / "scene/pipe").string() + "'").c_str()), 0);
  const std::string only = "\" is not a file in the scene's folder, which is all that is read",
                    leads = "\" leads out of the scene's folder, which is all that is read";
  Json json = Json::parse(square().gltf());
  const std::pair<std::string, std::string> cases[] = {
      {"parts/room%20one.bin", ""},
      {"./parts/room one.bin", ""},
      {"parts/../parts/room one.bin", ""},
      {"../scene/parts/room one.bin", ""},
      {"link.bin", ""},
      {"../README.md", "\"../README.md" + only},
      {"%2e%2e/README.md", "\"../README.md" + only},
      {"/etc/passwd", "\"/etc/passwd" + only},
      {"http://example.org/a.bin", "\"http://example.org/a.bin" + only},
      {"file:///etc/passwd", "\"file:///etc/passwd" + only},
      {"room.bin", "\"room.bin" + leads},
      {"door/room.bin", "\"door/room.bin" + leads},
      {"nowhere.bin", "\"nowhere.bin\" cannot be opened: No such file or directory"},
      {".", "\".\" is no regular file"},
      {"pipe", "\"pipe\" is no regular file"},  // nobody waits for it
      {"data:;base64,A*==",
       "data URI cannot be decoded, expected \"data:...;base64,\" and base64"}};
  for (const auto& [uri, says] : cases) {
    json["buffers"][0]["uri"] = uri;
    EXPECT_EQ(refusal_of_file(folder.write("scene/a.gltf", json.dump())),
              says.empty() ? "" : "buffers[0].uri: " + says);
  }
  EXPECT_TRUE(refusal_of_file("/nowhere/room.glb").starts_with(" cannot be opened"));
  EXPECT_NE(refusal_of_file(folder.path.string()).find("is a folder"), std::string::npos);
}

TEST(ExternalFiles, AScenesHashCoversThem) {
  const TempFolder folder;
  Json json = Json::parse(square().gltf());
  json["buffers"][0]["uri"] = "room.bin";
  const std::string scene = folder.write("a.gltf", json.dump());
  const auto hash_with = [&](const std::string& buffer) {
    folder.write("room.bin", buffer);
    return read_gltf(scene).hash;
  };
  std::string buffer = square().bin;
  const std::string before = hash_with(buffer);
  EXPECT_EQ(hash_with(buffer), before);
  buffer[14] ^= 1;
  EXPECT_NE(hash_with(buffer), before);
}

// What a small file multiplies is refused before it takes memory or time.
TEST(Size, IsBoundedBeforeItIsTaken) {
  const auto mesh = [](GlbBuilder& b, size_t vertices) {
    return b.mesh({{"attributes", {{"POSITION", b.floats(std::vector<float>(3 * vertices), 3)}}}});
  };
  GlbBuilder nodes;
  mesh(nodes, 90000);
  for (int i = 0; i < 1500; ++i) nodes.node({{"mesh", 0}});
  EXPECT_EQ(refusal(nodes.glb()),
            "nodes[1491]: brings the scene to 134280000 vertices and 44760000 triangles, expected "
            "at most 134217728 and 268435456");

  GlbBuilder instances;
  mesh(instances, 10000);
  instances.json["accessors"].push_back(
      {{"componentType", 5126}, {"count", 100000}, {"type", "VEC3"}});
  instances.node(
      {{"mesh", 0},
       {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", 1}}}}}}}});
  EXPECT_TRUE(refusal(instances.glb())
                  .starts_with("nodes[0]: brings the scene to 1000000000 vertices and 333300000 "
                               "triangles, expected at most"));

  GlbBuilder targets;
  mesh(targets, 30000);
  targets.json["meshes"][0]["primitives"][0]["targets"] = Json(80000, Json{{"POSITION", 0}});
  targets.node({{"mesh", 0}, {"weights", Json(80000, 1)}});
  EXPECT_TRUE(refusal(targets.glb())
                  .starts_with("nodes[0]: brings the scene to 2400080000 vertices times morph "
                               "targets and joints, expected at most "));

  GlbBuilder images;
  std::string image = png_of(1, 1, "\1\2\3\4");  // claims 8192 x 8192 texels
  image.replace(16, 8, std::string("\0\0\x20\0\0\0\x20\0", 8));
  image += std::string(300000, '\0');  // enough bytes to make that plausible
  std::vector<Json> materials(5, lambert(1, 1, 1));
  for (Json& m : materials)
    m["pbrMetallicRoughness"]["baseColorTexture"]["index"] = images.texture(image);
  try {
    scene_with(materials, images);
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("images[4]: brings the scene to 335544320 texels, "
                                         "expected at most 268435456"),
              std::string::npos);
  }
}

}  // namespace tdpt::testing::malformed_test
