#include "libcommon/testing/files/compress.h"

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <meshoptimizer.h>
#include <webp/decode.h>
#include <webp/encode.h>
#include <cstring>
#include <stdexcept>

#include "libcommon/testing/files/glb_builder.h"
#include "libcommon/testing/files/read_png.h"

namespace tdpt::testing {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kI8 = 5120, kU16 = 5123, kFloat = 5126;
constexpr const char* kDraco = "KHR_draco_mesh_compression";

void expect(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(std::string("compress: ") + what);
}

uint32_t word(const std::string& bytes, size_t at) {
  uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A scene being edited; unused data remain in its buffer.
class Scene {
 public:
  explicit Scene(const std::string& glb) {
    const size_t json_size = word(glb, 12);
    b_.json = Json::parse(glb.substr(20, json_size));
    b_.bin = glb.substr(28 + json_size, word(glb, 20 + json_size));
  }

  /// `fallback`: size of a second buffer without data.
  std::string glb(size_t fallback, const char* extension) const {
    Json j = b_.json;
    j["buffers"] = Json::array({{{"byteLength", b_.bin.size()}}});
    if (fallback > 0)
      j["buffers"].push_back(
          {{"byteLength", fallback}, {"extensions", {{extension, {{"fallback", true}}}}}});
    return glb_of(j.dump(), b_.bin);
  }

  void require(const char* extension) {
    for (const char* list : {"extensionsUsed", "extensionsRequired"})
      b_.json[list].push_back(extension);
  }

  template <class Visit>
  void each_primitive(const Visit& visit) {
    for (Json& mesh : b_.json["meshes"])
      for (Json& primitive : mesh["primitives"]) visit(primitive);
  }

  Json& accessor(const Json& index) { return b_.json["accessors"][index.get<size_t>()]; }
  Json& view(const Json& index) { return b_.json["bufferViews"][index.get<size_t>()]; }

  std::string slice(const Json& where) const {
    return b_.bin.substr(where.value("byteOffset", size_t{0}), where["byteLength"].get<size_t>());
  }
  std::string content(const Json& accessor) {
    expect(accessor.contains("bufferView"), "an accessor without a bufferView");
    return slice(view(accessor["bufferView"]));
  }
  std::vector<float> floats(const Json& accessor) {
    expect(accessor["componentType"] == kFloat, "an attribute that is not of floats");
    const std::string bytes = content(accessor);
    std::vector<float> out(bytes.size() / sizeof(float));
    std::memcpy(out.data(), bytes.data(), bytes.size());
    return out;
  }
  std::vector<uint16_t> indices(const Json& accessor) {
    expect(accessor["componentType"] == kU16, "indices that are not of 16 bits");
    const std::string bytes = content(accessor);
    std::vector<uint16_t> out(bytes.size() / 2);
    std::memcpy(out.data(), bytes.data(), bytes.size());
    return out;
  }

  GlbBuilder b_;
};

int components_of(const Json& accessor) {
  const auto type = accessor["type"].get<std::string>();
  return type == "SCALAR" ? 1 : type.back() - '0';
}

// Draco

draco::GeometryAttribute::Type type_of(const std::string& name) {
  return name == "POSITION" ? draco::GeometryAttribute::POSITION
         : name == "NORMAL" ? draco::GeometryAttribute::NORMAL
                            : draco::GeometryAttribute::TEX_COORD;
}

std::string draco_of(Scene& s, const Json& primitive, bool quantized) {
  draco::Mesh mesh;
  const std::vector<uint16_t> corner = s.indices(s.accessor(primitive["indices"]));
  for (size_t i = 0; i < corner.size(); i += 3)
    mesh.AddFace({draco::PointIndex(corner[i]), draco::PointIndex(corner[i + 1]),
                  draco::PointIndex(corner[i + 2])});
  for (const auto& [name, index] : primitive["attributes"].items()) {
    const Json& accessor = s.accessor(index);
    const std::vector<float> values = s.floats(accessor);
    const int n = components_of(accessor);
    const auto count = accessor["count"].get<uint32_t>();
    mesh.set_num_points(count);
    draco::GeometryAttribute a;
    a.Init(type_of(name), nullptr, static_cast<int8_t>(n), draco::DT_FLOAT32, false, 4 * n, 0);
    const int id = mesh.AddAttribute(a, true, count);
    for (uint32_t i = 0; i < count; ++i)
      mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i),
                                            values.data() + i * static_cast<size_t>(n));
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(quantized ? draco::MESH_EDGEBREAKER_ENCODING
                                      : draco::MESH_SEQUENTIAL_ENCODING);
  for (const char* name : {"POSITION", "NORMAL", "TEXCOORD_0"})
    if (quantized) encoder.SetAttributeQuantization(type_of(name), 10);
  draco::EncoderBuffer buffer;
  expect(encoder.EncodeMeshToBuffer(mesh, &buffer).ok(), "Draco did not encode");
  return {buffer.data(), buffer.size()};
}

void compress_by_draco(Scene& s, bool quantized) {
  s.each_primitive([&](Json& p) {
    const int view = s.b_.view(draco_of(s, p, quantized));
    Json ids = Json::object();
    for (const auto& [name, index] : p["attributes"].items()) ids[name] = ids.size();
    p["extensions"][kDraco] = {{"bufferView", view}, {"attributes", ids}};
  });
  s.each_primitive([&](Json& p) {
    s.accessor(p["indices"]).erase("bufferView");
    for (const auto& [name, index] : p["attributes"].items()) s.accessor(index).erase("bufferView");
  });
  s.require(kDraco);
}

void decompress_draco(Scene& s, Json& p) {
  const Json e = p["extensions"][kDraco];
  p["extensions"].erase(kDraco);
  const std::string bytes = s.slice(s.view(e["bufferView"]));
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  expect(decoded.ok(), "Draco did not decode");
  const draco::Mesh& mesh = *decoded.value();
  std::vector<uint32_t> corner;
  for (uint32_t f = 0; f < mesh.num_faces(); ++f)
    for (const auto& c : mesh.face(draco::FaceIndex(f))) corner.push_back(c.value());
  p["indices"] = s.b_.indices_u32(corner);
  for (const auto& [name, id] : e["attributes"].items()) {
    const draco::PointAttribute* a = mesh.GetAttributeByUniqueId(id.get<uint32_t>());
    const auto n = static_cast<size_t>(a->num_components());
    std::vector<float> values(n * mesh.num_points());
    for (uint32_t i = 0; i < mesh.num_points(); ++i)
      a->GetMappedValue(draco::PointIndex(i), values.data() + n * i);
    p["attributes"][name] = s.b_.floats(values, static_cast<int>(n));
  }
}

// meshoptimizer

class MeshoptEncoder {
 public:
  MeshoptEncoder(Scene& s, Compression c)
      : s_(s),
        triangles_(c == Compression::meshopt_triangles),
        filters_(c == Compression::meshopt_filters),
        name_(c == Compression::meshopt_khr ? "KHR_meshopt_compression"
                                            : "EXT_meshopt_compression") {}

  std::string run() {
    s_.each_primitive([&](Json& p) {
      for (const auto& [name, index] : p["attributes"].items()) attribute(name, s_.accessor(index));
      indices(s_.accessor(p["indices"]));
    });
    s_.require(name_);
    if (filters_) s_.require("KHR_mesh_quantization");
    return s_.glb(fallback_, name_);
  }

 private:
  void attribute(const std::string& name, Json& accessor) {
    const std::vector<float> values = s_.floats(accessor);
    const auto count = accessor["count"].get<size_t>();
    const auto n = static_cast<size_t>(components_of(accessor));
    std::string raw = bytes_of(values), filter = "NONE";
    size_t stride = 4 * n;
    if (filters_ && name == "POSITION") {
      filter = "EXPONENTIAL";
#if MESHOPTIMIZER_VERSION >= 190
      meshopt_encodeFilterExp(raw.data(), count, stride, 12, values.data(),
                              meshopt_EncodeExpSharedVector);
#else
      meshopt_encodeFilterExp(raw.data(), count, stride, 12, values.data());
#endif
    } else if (filters_ && name == "NORMAL") {
      filter = "OCTAHEDRAL", stride = 4;
      std::vector<float> four;
      for (size_t i = 0; i < count; ++i)
        four.insert(four.end(), {values[3 * i], values[3 * i + 1], values[3 * i + 2], 0});
      raw.resize(stride * count);
      meshopt_encodeFilterOct(raw.data(), count, stride, 6, four.data());
      accessor["componentType"] = kI8, accessor["normalized"] = true;
      accessor.erase("min"), accessor.erase("max");
    }
    std::string out(meshopt_encodeVertexBufferBound(count, stride), '\0');
    out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                          raw.data(), count, stride));
    put(accessor, out, "ATTRIBUTES", filter, count, stride);
    s_.view(accessor["bufferView"])["byteStride"] = stride;
  }

  void indices(Json& accessor) {
    const std::vector<uint16_t> raw = s_.indices(accessor);
    std::vector<unsigned> wide(raw.begin(), raw.end());
    std::string out(meshopt_encodeIndexSequenceBound(raw.size(), 65536) +
                        meshopt_encodeIndexBufferBound(raw.size(), 65536),
                    '\0');
    auto* to = reinterpret_cast<unsigned char*>(out.data());
    meshopt_encodeIndexVersion(1);
    out.resize(triangles_ ? meshopt_encodeIndexBuffer(to, out.size(), wide.data(), wide.size())
                          : meshopt_encodeIndexSequence(to, out.size(), wide.data(), wide.size()));
    put(accessor, out, triangles_ ? "TRIANGLES" : "INDICES", "NONE", raw.size(), 2);
  }

  void put(const Json& accessor, const std::string& data, const char* mode,
           const std::string& filter, size_t count, size_t stride) {
    expect(!data.empty(), "meshoptimizer did not encode");
    const Json made = s_.view(s_.b_.view(data));
    s_.b_.json["bufferViews"].erase(s_.b_.json["bufferViews"].size() - 1);
    s_.view(accessor["bufferView"]) = {{"buffer", 1},
                                       {"byteOffset", fallback_},
                                       {"byteLength", count * stride},
                                       {"extensions",
                                        {{name_,
                                          {{"buffer", 0},
                                           {"byteOffset", made["byteOffset"]},
                                           {"byteLength", data.size()},
                                           {"byteStride", stride},
                                           {"mode", mode},
                                           {"filter", filter},
                                           {"count", count}}}}}};
    fallback_ += (count * stride + 3) / 4 * 4;
  }

  Scene& s_;
  bool triangles_, filters_;
  const char* name_;
  size_t fallback_ = 0;
};

void decompress_meshopt(Scene& s, Json& view, const Json& e) {
  const std::string in = s.slice(e);
  const auto count = e["count"].get<size_t>(), stride = e["byteStride"].get<size_t>();
  const auto mode = e["mode"].get<std::string>(), filter = e.value("filter", "NONE");
  std::string out(count * stride, '\0');
  const auto* from = reinterpret_cast<const unsigned char*>(in.data());
  const int fault = mode == "ATTRIBUTES"
                        ? meshopt_decodeVertexBuffer(out.data(), count, stride, from, in.size())
                    : mode == "TRIANGLES"
                        ? meshopt_decodeIndexBuffer(out.data(), count, stride, from, in.size())
                        : meshopt_decodeIndexSequence(out.data(), count, stride, from, in.size());
  expect(fault == 0, "meshoptimizer did not decode");
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), count, stride);
  s.b_.bin.resize((s.b_.bin.size() + 3) / 4 * 4);
  view["buffer"] = 0;
  view["byteOffset"] = s.b_.bin.size();
  view.erase("extensions");
  s.b_.bin += out;
}

// WebP

void compress_by_webp(Scene& s, bool lossless) {
  for (Json& texture : s.b_.json["textures"]) {
    const Json image = s.b_.json["images"][texture["source"].get<size_t>()];
    const PngPixels png = read_png(s.slice(s.view(image["bufferView"])));
    std::vector<uint8_t> rgb;
    for (const auto& texel : png.rgb) rgb.insert(rgb.end(), texel.begin(), texel.end());
    uint8_t* out = nullptr;
    const size_t size =
        lossless ? WebPEncodeLosslessRGB(rgb.data(), png.width, png.height, 3 * png.width, &out)
                 : WebPEncodeRGB(rgb.data(), png.width, png.height, 3 * png.width, 50, &out);
    expect(size > 0, "libwebp did not encode");
    const int view = s.b_.view({reinterpret_cast<const char*>(out), size});
    WebPFree(out);
    texture["extensions"]["EXT_texture_webp"]["source"] = s.b_.json["images"].size();
    texture.erase("source");
    s.b_.json["images"].push_back({{"bufferView", view}, {"mimeType", "image/webp"}});
  }
  s.require("EXT_texture_webp");
}

void decompress_webp(Scene& s, Json& texture) {
  const auto source = texture["extensions"]["EXT_texture_webp"]["source"].get<size_t>();
  const std::string in = s.slice(s.view(s.b_.json["images"][source]["bufferView"]));
  int width = 0, height = 0;
  uint8_t* rgba =
      WebPDecodeRGBA(reinterpret_cast<const uint8_t*>(in.data()), in.size(), &width, &height);
  expect(rgba != nullptr, "libwebp did not decode");
  const auto size = size_t{4} * static_cast<size_t>(width) * static_cast<size_t>(height);
  const int view = s.b_.view(png_of(width, height, {reinterpret_cast<const char*>(rgba), size}));
  WebPFree(rgba);
  texture.erase("extensions");
  texture["source"] = s.b_.json["images"].size();
  s.b_.json["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}});
}

}  // namespace

const std::vector<NamedCompression> kCompressions{
    {Compression::draco_sequential, "draco_sequential", true},
    {Compression::draco_edgebreaker, "draco_edgebreaker", false},
    {Compression::meshopt, "meshopt", true},
    {Compression::meshopt_khr, "meshopt_khr", true},
    {Compression::meshopt_triangles, "meshopt_triangles", true},
    {Compression::meshopt_filters, "meshopt_filters", false},
    {Compression::webp_lossless, "webp_lossless", true},
    {Compression::webp_lossy, "webp_lossy", false},
};

std::string compress(const std::string& glb, Compression c) {
  Scene s(glb);
  if (c == Compression::webp_lossless || c == Compression::webp_lossy)
    compress_by_webp(s, c == Compression::webp_lossless);
  else if (c == Compression::draco_sequential || c == Compression::draco_edgebreaker)
    compress_by_draco(s, c == Compression::draco_edgebreaker);
  else
    return MeshoptEncoder(s, c).run();
  return s.glb(0, "");
}

std::string decompress(const std::string& glb) {
  Scene s(glb);
  Json& j = s.b_.json;
  j.erase("extensionsRequired");
  for (Json& view : j["bufferViews"])
    if (view.contains("extensions"))
      decompress_meshopt(s, view, Json(view["extensions"].begin().value()));
  s.each_primitive([&](Json& p) {
    if (p.contains("extensions") && p["extensions"].contains(kDraco)) decompress_draco(s, p);
  });
  if (j.contains("textures"))
    for (Json& texture : j["textures"])
      if (texture.contains("extensions")) decompress_webp(s, texture);
  return s.glb(0, "");
}

}  // namespace tdpt::testing
