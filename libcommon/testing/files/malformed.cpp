#include "libcommon/testing/files/malformed.h"

#include <cstring>
#include <limits>

#include "libcommon/testing/files/malformed_list.h"

namespace tdpt::testing {
namespace {

void set_u32(std::string& bytes, size_t at, uint32_t value) {
  for (size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>((value >> (8 * i)) & 255);
}
uint32_t get_u32(const std::string& bytes, size_t at) {
  uint32_t value;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

void container(MalformedList& l) {
  l.raw("empty", "", " is empty, expected a glTF 2.0 scene");
  l.raw("text", "hello\n",
        " is no glTF scene, expected \"glTF\" (.glb) or \"{\" (.gltf) at its start: export it as "
        "glTF "
        "2.0 from its program, or convert it by tdpt-import (Mitsuba, pbrt, Tungsten)");
  l.raw("header-short", "glTF\2", "header: is cut short after 5 bytes, expected 12");
  l.spoil_bytes(
      "version-1", [](auto& s) { set_u32(s, 4, 1); }, "header: version is 1, expected 2");
  l.spoil_bytes(
      "cut-short", [](auto& s) { s.resize(700); },
      "header: the file is cut short: 700 bytes, expected 888");
  l.spoil_bytes(
      "chunk-header-short",
      [](auto& s) {
        s.resize(20 + get_u32(s, 12) + 4);
        set_u32(s, 8, static_cast<uint32_t>(s.size()));
      },
      "chunk[1]: is cut short: 4 bytes, expected a header of 8");
  l.spoil_bytes(
      "chunk-too-long", [](auto& s) { set_u32(s, 12, 100000); },
      "chunk[0]: declares 100000 bytes, but 868 are left in the file");
  l.spoil_bytes(
      "chunk-type", [](auto& s) { s[16] = 'X'; },
      "chunk[0]: is not JSON, expected the JSON chunk first");
  l.raw("no-chunks", std::string("glTF\2\0\0\0\14\0\0\0", 12),
        "chunk[0]: is missing or empty, expected the JSON chunk");
}

void json(MalformedList& l) {
  l.raw("json-cut-short", R"({"asset": {"version": "2.0"}, "nodes": [)",
        "JSON byte 41: is not valid JSON");
  l.raw("json-number", R"({"asset": {"version": "2.0"}, "scene": 1e999})",
        "JSON: holds a number beyond the range of double precision");
  l.raw("json-deep", R"({"asset": )" + std::string(5000, '[') + std::string(5000, ']') + "}",
        "JSON: is nested more than 64 levels deep");
  l.raw("asset-missing", "{}",
        "asset: is missing, so this is no glTF scene: export it as glTF 2.0 from its program, or "
        "convert it by tdpt-import (Mitsuba, pbrt, Tungsten)");
  l.replace("asset-version", "/asset/version", "1.0",
            "asset.version: is \"1.0\", expected \"2.0\"");
  l.spoil(
      "asset-version-and-all",
      [](GlbBuilder& b) {
        b.json["asset"]["version"] = "1.0";
        b.json["meshes"] = {{"square", b.json["meshes"][0]}};
      },
      "asset.version: is \"1.0\", expected \"2.0\"");
  l.replace("section-type", "/nodes", Json::object(), "nodes: is an object, expected an array");
  l.replace("element-type", "/nodes/1", 7, "nodes[1]: is 7, expected an object");
  l.replace("text-type", "/materials/0/alphaMode", 7,
            "materials[0].alphaMode: is 7, expected a string");
  l.replace("boolean-type", "/materials/0/doubleSided", "yes",
            "materials[0].doubleSided: is \"yes\", expected true or false");
  l.replace("number-type", "/materials/0/pbrMetallicRoughness/metallicFactor", "0",
            "materials[0].pbrMetallicRoughness.metallicFactor: is \"0\", expected a number");
  l.replace(
      "number-range", "/materials/0/pbrMetallicRoughness/metallicFactor", 2,
      "materials[0].pbrMetallicRoughness.metallicFactor: is 2, expected a number from 0 to 1");
  l.replace("integer-type", "/accessors/0/count", "4",
            "accessors[0].count: is \"4\", expected an integer");
  l.replace("count-negative", "/accessors/0/count", -4,
            "accessors[0].count: is -4, expected an integer from 1 to 9007199254740992");
  l.replace("count-fraction", "/accessors/0/count", 3.5,
            "accessors[0].count: is 3.5, expected an integer from 1 to 9007199254740992");
  l.replace("numbers-count", "/nodes/0/translation", {1, 2},
            "nodes[0].translation: is an array of 2, expected an array of 3 numbers");
  l.replace("indices-type", "/nodes/0/children", 1,
            "nodes[0].children: is 1, expected an array of indices");
  l.replace("mesh-missing", "/nodes/0/mesh", 3,
            "nodes[0].mesh: is 3, expected an index into the 1 meshes");
  l.replace("child-missing", "/nodes/0/children", {9},
            "nodes[0].children[0]: is 9, expected an index into the 2 nodes");
  l.replace("accessor-missing", "/meshes/0/primitives/0/indices", 7,
            "meshes[0].primitives[0].indices: is 7, expected an index into the 2 accessors");
  l.replace("view-missing", "/accessors/0/bufferView", 2,
            "accessors[0].bufferView: is 2, expected an index into the 2 bufferViews");
  l.replace("scene-missing", "/scene", 1, "scene: is 1, expected an index into the 1 scenes");
  l.replace("extension-type", "/materials/0/extensions", {{"KHR_materials_specular", 3}},
            "materials[0].extensions.KHR_materials_specular: is 3, expected an object");
  l.replace("requires-ACME_unknown", "/extensionsRequired", Json::array({"ACME_unknown"}),
            "extensionsRequired: \"ACME_unknown\" is not supported, expected a scene exported "
            "without it");
  l.replace("requires-control-characters", "/extensionsRequired",
            Json::array({"two\nlines\x1b[2J"}),
            "extensionsRequired: \"two?lines?[2J\" is not supported, expected a scene exported "
            "without it");
  l.replace("extensions-list", "/extensionsRequired", "x",
            "extensionsRequired: is \"x\", expected an array");
  l.replace("extensions-names", "/extensionsRequired", {1},
            "extensionsRequired[0]: is 1, expected a string");
}

void buffers(MalformedList& l) {
  const std::string only = " is not a file in the scene's folder, which is all that is read";
  l.uri("uri-above", "../scenes/two-rooms.glb",
        "buffers[0].uri: \"../scenes/two-rooms.glb\"" + only);
  l.uri("uri-above-encoded", "%2e%2e/README.md", "buffers[0].uri: \"../README.md\"" + only);
  l.uri("uri-absolute", "/etc/passwd", "buffers[0].uri: \"/etc/passwd\"" + only);
  l.uri("uri-http", "http://example.org/a.bin",
        "buffers[0].uri: \"http://example.org/a.bin\"" + only);
  l.uri("uri-file", "file:///etc/passwd", "buffers[0].uri: \"file:///etc/passwd\"" + only);
  l.uri("uri-missing", "nowhere.bin",
        "buffers[0].uri: \"nowhere.bin\" cannot be opened: No such file or directory");
  l.uri("uri-folder", ".", "buffers[0].uri: \".\" is no regular file");
  l.uri("uri-data", "data:application/octet-stream;base64,A*==",
        "buffers[0].uri: data URI cannot be decoded, expected \"data:...;base64,\" and base64");
  l.uri("buffer-short", "data:application/octet-stream;base64,AA==",
        "buffers[0]: is cut short: 1 byte, expected 60");
  Json nowhere = Json::parse(square().gltf());
  nowhere["buffers"][0].erase("uri");
  l.raw("buffer-nowhere", nowhere.dump(1), "buffers[0]: has neither a uri nor a binary chunk");
}

void accessors(MalformedList& l) {
  l.replace("accessor-component-type", "/accessors/0/componentType", 5124,
            "accessors[0].componentType: is 5124, expected 5120, 5121, 5122, 5123, 5125 or 5126 "
            "(float)");
  l.replace(
      "accessor-type", "/accessors/0/type", "VEC5",
      "accessors[0].type: is \"VEC5\", expected SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
  l.replace("view-beyond-buffer", "/bufferViews/0/byteLength", 61,
            "bufferViews[0]: 61 bytes from byte 0 reach beyond buffers[0] of 60 bytes");
  l.replace("view-offset-overflow", "/bufferViews/0/byteOffset", 9007199254740992,
            "bufferViews[0]: 48 bytes from byte 9007199254740992 reach beyond buffers[0] of 60 "
            "bytes");
  l.replace("accessor-beyond-view", "/accessors/0/count", 5,
            "accessors[0]: 5 elements, 12 bytes apart, from byte 0 reach beyond bufferViews[0] of "
            "48 bytes");
  l.replace("accessor-count-overflow", "/accessors/0/count", 9007199254740992,
            "accessors[0]: 9007199254740992 elements, 12 bytes apart, from byte 0 reach beyond "
            "bufferViews[0] of 48 bytes");
  l.replace("accessor-offset", "/accessors/0/byteOffset", 4,
            "accessors[0]: 4 elements, 12 bytes apart, from byte 4 reach beyond bufferViews[0] of "
            "48 bytes");
  l.replace("stride-small", "/bufferViews/0/byteStride", 8,
            "accessors[0]: elements of 12 bytes do not fit the byteStride 8 of bufferViews[0]");
  l.replace("stride-range", "/bufferViews/0/byteStride", 2,
            "bufferViews[0].byteStride: is 2, expected an integer from 4 to 252");
  l.replace("positions-vec2", "/accessors/0/type", "VEC2",
            "accessors[0].type: positions are not VEC3");
  l.spoil(
      "positions-nan",
      [](GlbBuilder& b) {
        const float nan = std::numeric_limits<float>::quiet_NaN();
        std::memcpy(b.bin.data() + 12, &nan, 4);
      },
      "accessors[0]: element 1 of positions is not finite");
  l.spoil(
      "positions-infinite",
      [](GlbBuilder& b) {
        const float infinite = std::numeric_limits<float>::infinity();
        std::memcpy(b.bin.data() + 44, &infinite, 4);
      },
      "accessors[0]: element 3 of positions is not finite");
  l.spoil(
      "claims-memory",
      [](GlbBuilder& b) {
        b.json["accessors"][0].erase("bufferView");
        b.json["accessors"][0]["count"] = 4000000000;
      },
      "accessors[0]: 4000000000 elements without a bufferView, expected at most 884, the "
      "bytes of the file");
  l.replace("index-out-of-range", "/accessors/0/count", 3,
            "accessors[1]: index 3 at 5 is out of range, the primitive has 3 vertices");
  l.replace("indices-vector", "/accessors/1/type", "VEC2",
            "accessors[1].type: indices are not SCALAR");
  l.replace("indices-signed", "/accessors/1/componentType", 5122,
            "accessors[1].componentType: indices are of type 5122, expected 5121, 5123 or 5125");
  const auto sparse = [](int count, int type, int offset) {
    return Json{{"count", count},
                {"indices", {{"bufferView", 1}, {"componentType", type}, {"byteOffset", offset}}},
                {"values", {{"bufferView", 0}}}};
  };
  l.spoil(
      "sparse-index",
      [&](GlbBuilder& b) {
        b.bin += std::string("\7\0\0\0", 4);
        b.json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", b.bin.size() - 4}, {"byteLength", 4}});
        b.json["accessors"][0]["sparse"] = sparse(1, 5123, 0);
        b.json["accessors"][0]["sparse"]["indices"]["bufferView"] = 2;
      },
      "accessors[0].sparse.indices: index 7 is out of range, the accessor has 4 elements");
  l.replace("sparse-index-type", "/accessors/0/sparse", sparse(1, 5126, 0),
            "accessors[0].sparse.indices.componentType: is 5126, expected 5121, 5123 or 5125");
  l.replace("sparse-indices-beyond", "/accessors/0/sparse", sparse(4, 5125, 0),
            "accessors[0].sparse.indices: 4 elements, 4 bytes apart, from byte 0 reach beyond "
            "bufferViews[1] of 12 bytes");
  l.replace("sparse-values-beyond", "/accessors/0/sparse", sparse(5, 5123, 0),
            "accessors[0].sparse.values: 5 elements, 12 bytes apart, from byte 0 reach beyond "
            "bufferViews[0] of 48 bytes");
}

void nodes(MalformedList& l) {
  l.spoil(
      "node-cycle",
      [](GlbBuilder& b) {
        b.json["nodes"].push_back({{"children", {3}}});
        b.node({{"children", {2}}});
      },
      "nodes[2]: is its own ancestor, expected a tree of nodes");
  l.replace("node-own-child", "/nodes/0/children", {0},
            "nodes[0]: is its own ancestor, expected a tree of nodes");
  l.spoil(
      "node-twice",
      [](GlbBuilder& b) {
        b.node({{"children", {0}}});
        b.node({{"children", {0}}});
        b.json["scenes"][0]["nodes"] = {2, 3};
      },
      "nodes[0]: is reached twice, from nodes[2] and nodes[3]");
  l.replace("matrix-not-affine", "/nodes/0/matrix",
            {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
            "nodes[0].matrix: is not affine, expected a last row of 0 0 0 1");
  l.replace("rotation-zero", "/nodes/0/rotation", {0, 0, 0, 0},
            "nodes[0].rotation: is zero, expected a unit quaternion");
  l.spoil(
      "transform-overflow",
      [](GlbBuilder& b) {
        b.json["nodes"][0]["scale"] = {1e200, 1, 1};
        b.json["nodes"].push_back({{"scale", {1e200, 1, 1}}, {"children", {0}}});
        b.json["scenes"][0]["nodes"] = {2};
      },
      "nodes[0]: its transform and those above it exceed double precision");
  l.spoil(
      "vertex-overflow",
      [](GlbBuilder& b) {
        const float huge = 1e30f;
        std::memcpy(b.bin.data() + 12, &huge, 4);
        b.json["nodes"][0]["scale"] = {1e300, 1, 1};
      },
      "nodes[0]: its transform takes a vertex beyond double precision");
  l.replace("camera-yfov-negative", "/cameras/0/perspective/yfov", -1,
            "cameras[0].perspective.yfov: is -1, expected an angle between 0 and pi");
  l.replace("camera-yfov-nan", "/cameras/0/perspective/yfov", "NaN",
            "cameras[0].perspective.yfov: is \"NaN\", expected a number");
  l.replace("camera-yfov-wide", "/cameras/0/perspective/yfov", 3.5,
            "cameras[0].perspective.yfov: is 3.5, expected an angle between 0 and pi");
  l.replace("camera-aspect", "/cameras/0/perspective/aspectRatio", 0,
            "cameras[0].perspective.aspectRatio: is 0, expected more than 0");
  l.replace("camera-type", "/cameras/0/type", "fisheye",
            "cameras[0].type: is \"fisheye\", expected perspective or orthographic");
}

void surfaces(MalformedList& l) {
  l.replace("no-position", "/meshes/0/primitives/0/attributes", {{"NORMAL", 0}},
            " has no triangles in its scene");
  l.spoil(
      "strip-of-two",
      [](GlbBuilder& b) {
        b.json["accessors"][1]["count"] = 2;
        b.json["meshes"][0]["primitives"][0]["mode"] = 5;
      },
      " has no triangles in its scene");
  l.replace("mode-unknown", "/meshes/0/primitives/0/mode", 7,
            "meshes[0].primitives[0].mode: is 7, expected an integer from 0 to 6");
  l.replace("no-triangles", "/scenes/0/nodes", {1}, " has no triangles in its scene");
  l.replace("no-area", "/nodes/0/scale", {0, 0, 0}, " has no triangle with an area");
  l.replace("area-zero", "/nodes/0/scale", {1, 0, 1}, " has no triangle with an area");
  l.replace("too-long", "/nodes/0/scale", {1e40, 1, 1},
            " is 1e+40 m long, expected 1e-30 to 1e+30");
  l.replace("emission-negative", "/materials/0/emissiveFactor", {1, -1, 1},
            "materials[0].emissiveFactor[1]: is -1, expected a number of at least 0");
  l.spoil(
      "emission-huge",
      [](GlbBuilder& b) {
        Json& m = b.json["materials"][0];
        m["emissiveFactor"] = {1, 1, 1};
        m["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 1e40;
      },
      "materials[0]: emits a radiance of 1e+40, expected at most 1e30");
}

// Rendering defaults in the scene's extras.
void defaults(MalformedList& l) {
  const std::string at = "scenes[0].extras.tdpt_";
  const std::string sky = "expected a file, or R,G,B: three numbers from 0 to 1e30";
  const auto spoil = [&](const std::string& name, const std::string& key, const Json& value,
                         const std::string& expected) {
    l.spoil(
        "extras-" + name,
        [&](GlbBuilder& b) { b.json["scenes"][0]["extras"]["tdpt_" + key] = value; },
        at + key + ": " + expected);
  };
  spoil("environment-type", "environment", true, "is true, " + sky);
  spoil("environment-colour", "environment", {1, 2}, "is an array of 2, " + sky);
  spoil("environment-text", "environment", "1,2", "is \"1,2\", " + sky);
  spoil("environment-black", "environment", "0,0,0",
        "is \"0,0,0\", expected a colour that is not black");
  spoil("rotation-range", "environment_rotation", 400,
        "is 400, expected a number from -360 to 360");
  spoil("scale-type", "environment_scale", "2", "is \"2\", expected a number");
  spoil("width-zero", "width", 0, "is 0, expected an integer from 1 to 65536");
  spoil("height-fraction", "height", 0.5, "is 0.5, expected an integer from 1 to 65536");
  spoil("camera-type", "camera", 1, "is 1, expected a string");
  l.replace("camera-of-extras-missing", "/scenes/0/extras", {{"tdpt_camera", "cellar"}},
            at + "camera: there is no camera \"cellar\", expected one of \"camera\"");
}

}  // namespace

std::vector<MalformedScene> malformed_scenes() {
  MalformedList l;
  container(l);
  json(l);
  buffers(l);
  accessors(l);
  nodes(l);
  surfaces(l);
  defaults(l);
  add_malformed_surfaces(l);
  add_malformed_compressed(l);
  add_malformed_motion(l);
  return l.scenes;
}

}  // namespace tdpt::testing
