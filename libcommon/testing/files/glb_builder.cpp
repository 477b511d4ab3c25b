#include "libcommon/testing/files/glb_builder.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tdpt::testing {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFloat = 5126, kU8 = 5121, kU16 = 5123, kU32 = 5125;
constexpr int kVertices = 34962, kIndices = 34963;  // bufferView targets

void append_u32(std::string& out, size_t value) {
  for (int i = 0; i < 4; ++i) out += static_cast<char>((value >> (8 * i)) & 255);
}

void append_big_endian(std::string& out, uint32_t value) {
  for (int i = 3; i >= 0; --i) out += static_cast<char>((value >> (8 * i)) & 255);
}

/// A PNG chunk: length, type, data and their CRC-32 (ISO 3309).
std::string png_chunk(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  uint32_t crc = ~0u;
  for (char c : body) {
    crc ^= static_cast<unsigned char>(c);
    for (int k = 0; k < 8; ++k) crc = crc & 1 ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
  }
  std::string out;
  append_big_endian(out, static_cast<uint32_t>(data.size()));
  out += body;
  append_big_endian(out, ~crc);
  return out;
}

/// A zlib stream of stored blocks (RFC 1950, 1951).
std::string stored(const std::string& data) {
  std::string out = "\x78\x01";
  uint32_t a = 1, b = 0;
  for (char c : data) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  for (size_t at = 0; at < data.size(); at += 65535) {
    const size_t n = std::min<size_t>(65535, data.size() - at);
    out += at + n == data.size() ? '\1' : '\0';
    for (size_t v : {n, ~n})
      out += static_cast<char>(v & 255), out += static_cast<char>(v >> 8 & 255);
    out.append(data, at, n);
  }
  append_big_endian(out, b << 16 | a);
  return out;
}

int append(Json& json, const char* section, Json value) {
  json[section].push_back(std::move(value));
  return static_cast<int>(json[section].size()) - 1;
}

// Rotation with columns right, up, -forward as a quaternion x y z w.
std::array<double, 4> look_at(std::array<double, 3> from, std::array<double, 3> to) {
  const double dx = to[0] - from[0], dy = to[1] - from[1], dz = to[2] - from[2];
  const double yaw = std::atan2(-dx, -dz), pitch = std::atan2(dy, std::hypot(dx, dz));
  const double sy = std::sin(yaw / 2), cy = std::cos(yaw / 2);
  const double sp = std::sin(pitch / 2), cp = std::cos(pitch / 2);
  // Six digits, so that the bytes do not depend on the last bit of a library's sine.
  const auto round = [](double v) { return std::round(v * 1e6) / 1e6; };
  return {round(cy * sp), round(sy * cp), round(-sy * sp), round(cy * cp)};
}

}  // namespace

GlbBuilder::GlbBuilder() {
  json["asset"] = {{"version", "2.0"}, {"generator", "tdpt make_scenes"}};
  json["scene"] = 0;
  json["scenes"] = Json::array({{{"nodes", Json::array()}}});
}

int GlbBuilder::view(std::string_view data, int stride) {
  bin.resize((bin.size() + 3) / 4 * 4);
  Json v = {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", data.size()}};
  if (stride > 0) v["byteStride"] = stride;
  bin += data;
  return append(json, "bufferViews", v);
}

int GlbBuilder::accessor(int view, int component_type, const std::string& type, size_t count,
                         size_t offset) {
  Json a = {
      {"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}};
  if (offset > 0) a["byteOffset"] = offset;
  return append(json, "accessors", a);
}

int GlbBuilder::floats(const std::vector<float>& values, int components) {
  const std::string type = components == 1 ? "SCALAR" : "VEC" + std::to_string(components);
  const int a = accessor(view(bytes_of(values)), kFloat, type,
                         values.size() / static_cast<size_t>(components));
  extend_limits(json["accessors"][static_cast<size_t>(a)], values, components);
  json["bufferViews"].back()["target"] = kVertices;
  return a;
}

void GlbBuilder::extend_limits(Json& a, const std::vector<float>& values, int components) {
  const auto n = static_cast<size_t>(components);
  if (values.empty()) return;
  std::vector<float> lo(values.begin(), values.begin() + components), hi = lo;
  for (size_t i = 0; i < values.size(); ++i) {
    lo[i % n] = std::min(lo[i % n], values[i]);
    hi[i % n] = std::max(hi[i % n], values[i]);
  }
  a["min"] = lo;
  a["max"] = hi;
}

int GlbBuilder::indices(int view, int component_type, size_t count) {
  json["bufferViews"].back()["target"] = kIndices;
  return accessor(view, component_type, "SCALAR", count);
}
int GlbBuilder::indices_u8(const std::vector<uint8_t>& values) {
  return indices(view(bytes_of(values)), kU8, values.size());
}
int GlbBuilder::indices_u16(const std::vector<uint16_t>& values) {
  return indices(view(bytes_of(values)), kU16, values.size());
}
int GlbBuilder::indices_u32(const std::vector<uint32_t>& values) {
  return indices(view(bytes_of(values)), kU32, values.size());
}

int GlbBuilder::texture(std::string_view image, Json sampler) {
  const bool png = image.starts_with("\x89PNG");
  const int i =
      append(json, "images",
             {{"bufferView", view(image)}, {"mimeType", png ? "image/png" : "image/jpeg"}});
  Json t = {{"source", i}};
  if (!sampler.empty()) t["sampler"] = append(json, "samplers", std::move(sampler));
  return append(json, "textures", t);
}

int GlbBuilder::material(Json m) {
  return append(json, "materials", std::move(m));
}

int GlbBuilder::mesh(Json primitive, const std::string& name) {
  Json m;
  if (!name.empty()) m["name"] = name;
  m["primitives"] = Json::array({std::move(primitive)});
  return append(json, "meshes", m);
}

int GlbBuilder::node(Json n) {
  const int index = append(json, "nodes", std::move(n));
  json["scenes"][0]["nodes"].push_back(index);
  return index;
}

int GlbBuilder::camera(const std::string& name, std::array<double, 3> from,
                       std::array<double, 3> to, double yfov, double aspect) {
  const int c =
      append(json, "cameras",
             {{"name", name},
              {"type", "perspective"},
              {"perspective", {{"yfov", yfov}, {"aspectRatio", aspect}, {"znear", 0.01}}}});
  node({{"name", name}, {"translation", from}, {"rotation", look_at(from, to)}, {"camera", c}});
  return c;
}

GlbBuilder GlbBuilder::of(const std::string& glb) {
  const auto length = [&](size_t at) {
    uint32_t value = 0;
    if (at + 4 <= glb.size()) std::memcpy(&value, glb.data() + at, 4);
    return value;
  };
  GlbBuilder b;
  b.json = Json::parse(glb.substr(20, length(12)));
  b.bin = glb.substr(20 + length(12) + 8, length(20 + length(12)));
  b.json["buffers"].erase(0);
  if (b.json["buffers"].empty()) b.json.erase("buffers");
  return b;
}

Json GlbBuilder::document() const {
  Json j = json;
  if (!bin.empty()) {  // the binary chunk is buffer 0; buffers in the JSON follow it
    j["buffers"] = Json::array({{{"byteLength", bin.size()}}});
    if (json.contains("buffers"))
      j["buffers"].insert(j["buffers"].end(), json["buffers"].begin(), json["buffers"].end());
  }
  return j;
}

std::string GlbBuilder::glb() const {
  return glb_of(document().dump(), bin);
}

std::string GlbBuilder::gltf() const {
  Json j = json;
  j["buffers"] = Json::array({{{"uri", "data:application/octet-stream;base64," + base64(bin)},
                               {"byteLength", bin.size()}}});
  return j.dump(1);
}

std::string glb_of(std::string json_text, std::string bin) {
  while (json_text.size() % 4 != 0) json_text += ' ';
  while (bin.size() % 4 != 0) bin += '\0';
  std::string out = "glTF";
  append_u32(out, 2);
  append_u32(out, 20 + json_text.size() + (bin.empty() ? 0 : 8 + bin.size()));
  append_u32(out, json_text.size());
  out += "JSON" + json_text;
  if (!bin.empty()) {
    append_u32(out, bin.size());
    out += std::string("BIN\0", 4) + bin;
  }
  return out;
}

std::string base64(std::string_view bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    const size_t n = std::min<size_t>(3, bytes.size() - i);
    for (size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) out += k <= n ? digits[(group >> (18 - 6 * k)) & 63] : '=';
  }
  return out;
}

std::string png_of(int width, int height, std::string_view texels, int bits) {
  std::string header, rows;
  append_big_endian(header, static_cast<uint32_t>(width));
  append_big_endian(header, static_cast<uint32_t>(height));
  header += static_cast<char>(bits);
  header += std::string("\6\0\0\0", 4);  // RGBA, deflate, no filter, not interlaced
  const size_t row = static_cast<size_t>(width) * static_cast<size_t>(bits / 2);
  for (size_t y = 0; y < static_cast<size_t>(height); ++y)
    rows.append(1, '\0').append(texels.substr(y * row, row));
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + png_chunk("IDAT", stored(rows)) +
         png_chunk("IEND", "");
}

}  // namespace tdpt::testing
