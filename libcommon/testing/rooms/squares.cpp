#include "libcommon/testing/rooms/squares.h"

namespace tdpt::testing {
namespace {

using Json = nlohmann::ordered_json;

std::string from_hex(std::string_view digits) {
  std::string out;
  const auto value = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  for (size_t i = 0; i + 1 < digits.size(); i += 2)
    out += static_cast<char>(16 * value(digits[i]) + value(digits[i + 1]));
  return out;
}

/// The square without any buffer.
GlbBuilder without_buffer() {
  GlbBuilder b = square();
  b.bin.clear();
  b.json["bufferViews"] = Json::array();
  return b;
}

}  // namespace

GlbBuilder square() {
  GlbBuilder b;
  const int position = b.floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
  const int index = b.indices_u16({0, 1, 2, 0, 2, 3});
  b.material({{"pbrMetallicRoughness", {{"metallicFactor", 0}}}});
  const int mesh =
      b.mesh({{"attributes", {{"POSITION", position}}}, {"indices", index}, {"material", 0}});
  b.node({{"mesh", mesh}});
  b.camera("camera", {0.5, 0.5, 2}, {0.5, 0.5, 0}, 1, 1);
  return b;
}

GlbBuilder square_by_draco() {
  GlbBuilder b = without_buffer();
  const int view = b.view(from_hex(
      "445241434f02020100000002040100010200020301010009030000000000000000000000000000000000803f0000"
      "0000000000000000803f0000803f00000000000000000000803f00000000"));
  for (Json& accessor : b.json["accessors"]) accessor.erase("bufferView");
  b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
  b.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return b;
}

GlbBuilder square_by_meshopt() {
  GlbBuilder b = without_buffer();
  b.bin = from_hex(
      "a000000133000000ffff01330000007e7d0000010c000000ff010c0000007e000000000000000000000000000000"
      "000000000000000000000000000000000000000000"
      "00"
      "d100040406080400000000");
  const auto view = [](size_t at, size_t bytes, size_t count, size_t stride, const char* mode) {
    return Json{{"buffer", 1},
                {"byteLength", count * stride},
                {"extensions",
                 {{"EXT_meshopt_compression",
                   {{"buffer", 0},
                    {"byteOffset", at},
                    {"byteLength", bytes},
                    {"byteStride", stride},
                    {"mode", mode},
                    {"count", count}}}}}};
  };
  b.json["bufferViews"] = {view(0, 67, 4, 12, "ATTRIBUTES"), view(68, 11, 6, 2, "INDICES")};
  b.json["buffers"] = {
      {{"byteLength", 60}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  b.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  return b;
}

std::string texels_by_webp() {
  return from_hex(
      "5249464638000000574542505650384c2c0000002f014000101f20242053b239361008100a852895252420563822"
      "fa"
      "ff8b8084f05c960b78a7d20dec4244ff23");
}

}  // namespace tdpt::testing
