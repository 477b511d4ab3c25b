// Malformed compressed scenes.
#include <functional>

#include "libcommon/testing/files/malformed_list.h"
#include "libcommon/testing/rooms/squares.h"

namespace tdpt::testing {
namespace {

const std::string kPrimitive = "meshes[0].primitives[0]";
const std::string kDraco = kPrimitive + ".extensions.KHR_draco_mesh_compression";

using Spoil = std::function<void(GlbBuilder&)>;

void add(MalformedList& l, GlbBuilder b, const std::string& name, const Spoil& spoil,
         const std::string& expected) {
  spoil(b);
  l.scenes.push_back({name + ".glb", b.glb(), expected});
}

Spoil set(const std::string& at, const Json& value) {
  return [=](GlbBuilder& b) { b.json[Json::json_pointer(at)] = value; };
}

void draco(MalformedList& l) {
  const std::string primitive = "/meshes/0/primitives/0";
  const std::string extension = primitive + "/extensions/KHR_draco_mesh_compression";
  const auto wrong = [&](const std::string& name, const Spoil& spoil, const std::string& expected) {
    add(l, square_by_draco(), "draco-" + name, spoil, expected);
  };
  wrong("view-missing", set(extension + "/bufferView", 1),
        kDraco + ".bufferView: is 1, expected an index into the 1 bufferViews");
  wrong("attribute-number", set(extension + "/attributes/POSITION", -1),
        kDraco + ".attributes.POSITION: is -1, expected an integer from 0 to 4294967295");
  wrong("attribute-alone", set(extension + "/attributes/NORMAL", 1),
        kPrimitive + ".attributes.NORMAL: is missing, but is compressed by Draco");
  wrong(
      "indices-missing",
      [](GlbBuilder& b) { b.json["meshes"][0]["primitives"][0].erase("indices"); },
      kPrimitive + ".indices: is missing, meshes compressed by Draco have some");
  wrong("no-position", set(extension + "/attributes", Json::object()),
        kDraco + ": has no attribute POSITION");
  wrong("attribute-missing", set(extension + "/attributes/POSITION", 7),
        kDraco + ": holds no attribute 7");
  wrong("components", set("/accessors/0/type", "VEC2"),
        kDraco + ": its attribute 0 has other components than its accessor");
  wrong("vertices", set("/accessors/0/count", 1),
        kDraco + ": holds 4 vertices, expected at most 2, as POSITION has 1");
  wrong("corners", set("/accessors/1/count", 1),
        kDraco + ": holds 6 corners of triangles, expected at most 3, as the indices are 1");
  wrong("claims-memory", set("/accessors/0/count", 9007199254740992),
        kDraco +
            ": declares 9007199254740992 vertices and 6 corners of triangles, which brings the "
            "scene to more than the 67186688 bytes expected at most");
  const std::string undecodable =
      kDraco + ": cannot be decoded, expected a mesh of Draco, version 2.2 at most";
  wrong(
      "magic", [](GlbBuilder& b) { b.bin[0] = 'd'; }, undecodable);
  wrong("cut-short", set("/bufferViews/0/byteLength", 60), undecodable);
  // 2^32 - 1 vertices: Draco allocates them before it reads them.
  wrong(
      "header-claims-memory", [](GlbBuilder& b) { b.bin.replace(12, 1, "\xff\xff\xff\xff\x0f"); },
      undecodable);
  wrong(
      "index", [](GlbBuilder& b) { b.bin[16] = 9; },
      "accessors[1]: index 9 at 2 is out of range, the primitive has 4 vertices");
}

void meshopt_fields(MalformedList& l) {
  const std::string extension = "/bufferViews/0/extensions/EXT_meshopt_compression";
  const std::string place = "bufferViews[0].extensions.EXT_meshopt_compression";
  const auto wrong = [&](const std::string& name, const Spoil& spoil, const std::string& expected) {
    add(l, square_by_meshopt(), "meshopt-" + name, spoil, place + expected);
  };
  wrong("mode", set(extension + "/mode", "LINES"),
        ".mode: is \"LINES\", expected ATTRIBUTES, TRIANGLES or INDICES");
  wrong("filter", set(extension + "/filter", "COLOR"),
        ".filter: is \"COLOR\", expected NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL");
  wrong(
      "filter-of-indices",
      [&](GlbBuilder& b) {
        Json& e = b.json[Json::json_pointer(extension)];
        e["mode"] = "INDICES", e["byteStride"] = 2, e["filter"] = "OCTAHEDRAL";
      },
      ".filter: is \"OCTAHEDRAL\", expected NONE where there are indices");
  wrong("stride", set(extension + "/byteStride", 10),
        ".byteStride: is 10, expected a multiple of 4");
  wrong("stride-octahedral", set(extension + "/filter", "OCTAHEDRAL"),
        ".byteStride: is 12, expected 4 or 8 with this filter");
  wrong("stride-quaternion", set(extension + "/filter", "QUATERNION"),
        ".byteStride: is 12, expected 8 with this filter");
  wrong("stride-of-indices", set(extension + "/mode", "TRIANGLES"),
        ".byteStride: is 12, expected 2 or 4, the bytes of an index");
  wrong("stride-of-view", set("/bufferViews/0/byteStride", 16),
        ".byteStride: is 12, expected 16 as of the bufferView");
  wrong(
      "triangles",
      [&](GlbBuilder& b) {
        Json& e = b.json[Json::json_pointer(extension)];
        e["mode"] = "TRIANGLES", e["byteStride"] = 2;
      },
      ".count: is 4, expected a multiple of 3");
}

void meshopt_data(MalformedList& l) {
  const std::string extension = "/bufferViews/0/extensions/EXT_meshopt_compression";
  const std::string place = "bufferViews[0].extensions.EXT_meshopt_compression: ";
  const auto wrong = [&](const std::string& name, const Spoil& spoil, const std::string& expected) {
    add(l, square_by_meshopt(), "meshopt-" + name, spoil, expected);
  };
  wrong("beyond-buffer", set(extension + "/byteLength", 80),
        place + "80 bytes from byte 0 reach beyond buffers[0] of 79 bytes");
  wrong("claims-memory", set(extension + "/count", 9007199254740992),
        place +
            "declares 9007199254740992 elements of 12 bytes, expected at most 4288 bytes from "
            "67");
  wrong("short", set(extension + "/count", 3),
        place + "declares 3 elements of 12 bytes, expected 48 bytes as the bufferView has");
  const std::string undecodable =
      place + "cannot be decoded, expected data of meshoptimizer, version 0";
  wrong("cut-short", set(extension + "/byteLength", 40), undecodable);
  wrong(
      "version-1", [](GlbBuilder& b) { b.bin[0] = '\xa1'; }, undecodable);
  wrong(
      "index",
      [](GlbBuilder& b) {
        b.bin[70] = 0x24;  // a step of 9
      },
      "accessors[1]: index 9 at 1 is out of range, the primitive has 4 vertices");
  // Two bufferViews of the same compressed zeros.
  wrong(
      "bytes-shared",
      [&](GlbBuilder& b) {
        b.bin = "\xa0" + std::string(512, '\0');
        Json& view = b.json["bufferViews"][0];
        view["byteLength"] = 30720;
        Json& e = view["extensions"]["EXT_meshopt_compression"];
        e["byteLength"] = b.bin.size(), e["count"] = 2560;
        b.json["bufferViews"].push_back(Json(view));
        b.json["accessors"].push_back(
            {{"bufferView", 2}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
        Json& primitives = b.json["meshes"][0]["primitives"];
        primitives[0].erase("indices"), primitives[0]["mode"] = 5;
        primitives.push_back(Json(primitives[0]));
        primitives[1]["attributes"]["POSITION"] = 2;
      },
      "bufferViews[2].extensions.EXT_meshopt_compression: brings the scene to 61440 bytes, "
      "expected "
      "at most 32832 from 513");
  wrong(
      "fallback-alone", [](GlbBuilder& b) { b.json["bufferViews"][0].erase("extensions"); },
      "buffers[1]: has neither a uri nor a binary chunk");
}

}  // namespace

void add_malformed_compressed(MalformedList& l) {
  draco(l);
  meshopt_fields(l);
  meshopt_data(l);
}

}  // namespace tdpt::testing
