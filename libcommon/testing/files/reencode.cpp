#include "libcommon/testing/files/reencode.h"

#include <cmath>
#include <cstring>

#include "libcommon/testing/files/glb_builder.h"

namespace tdpt::testing {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kI8 = 5120, kU8 = 5121, kI16 = 5122, kU16 = 5123, kFloat = 5126;
constexpr const char* kInstances = "EXT_mesh_gpu_instancing";
constexpr int kGrey = 0, kRed = 1, kTiles = 2, kLamp = 3;

void add_materials(GlbBuilder& b) {
  const Json no_lobe = {{"KHR_materials_specular", {{"specularFactor", 0}}}};
  b.json["extensionsUsed"] = {"KHR_materials_emissive_strength", "KHR_materials_specular"};
  const auto lambert = [](double r, double g, double blue) {
    return Json{
        {"baseColorFactor", {r, g, blue, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
  };
  std::string texels;
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      for (int c = 0; c < 4; ++c)
        texels += static_cast<char>(c == 3 ? 255 : 40 + (x * 91 + y * 53 + c * 37) % 200);
  Json tiles = lambert(0.9, 0.9, 0.9);
  tiles["baseColorTexture"] = {{"index", b.texture(png_of(4, 4, texels))}};
  for (const Json& pbr : {lambert(0.7, 0.7, 0.7), lambert(0.7, 0.3, 0.25), tiles})
    b.material({{"pbrMetallicRoughness", pbr}, {"extensions", no_lobe}, {"doubleSided", true}});
  Json glow = no_lobe;
  glow["KHR_materials_emissive_strength"] = {{"emissiveStrength", 6}};
  b.material({{"pbrMetallicRoughness", lambert(0, 0, 0)},
              {"emissiveFactor", {1, 1, 1}},
              {"extensions", glow}});
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

template <class Vectors>
std::vector<float> flat(const Vectors& vectors, int components) {
  std::vector<float> out;
  for (const auto& v : vectors)
    for (int c = 0; c < components; ++c) out.push_back(v[c]);
  return out;
}
std::vector<float> flat(const std::vector<std::array<float, 2>>& vectors) {
  std::vector<float> out;
  for (const auto& v : vectors) out.insert(out.end(), v.begin(), v.end());
  return out;
}

/// Two triangles of every quad.
std::vector<uint32_t> triangles(size_t quads, bool reversed) {
  std::vector<uint32_t> out;
  for (uint32_t q = 0; q < quads; ++q)
    for (uint32_t i : {0, 1, 2, 0, 2, 3}) out.push_back(4 * q + (reversed ? (4 - i) % 4 : i));
  return out;
}

template <class T>
std::vector<T> as(const std::vector<uint32_t>& values) {
  return {values.begin(), values.end()};
}

/// Positions with every third one wrong, and the sparse values that correct them.
int sparse_positions(GlbBuilder& b, const std::vector<Vec3f>& positions) {
  std::vector<Vec3f> wrong = positions;
  std::vector<uint16_t> which;
  std::vector<float> right;
  for (size_t i = 0; i < wrong.size(); i += 3) {
    which.push_back(static_cast<uint16_t>(i));
    for (int c = 0; c < 3; ++c) right.push_back(positions[i][c]);
    wrong[i] = {7, 8, 9};
  }
  const int accessor = b.floats(flat(wrong, 3), 3);
  const int indices = b.view(bytes_of(which)), values = b.view(bytes_of(right));
  Json& a = b.json["accessors"][static_cast<size_t>(accessor)];
  a["sparse"] = {{"count", which.size()},
                 {"indices", {{"bufferView", indices}, {"componentType", kU16}}},
                 {"values", {{"bufferView", values}}}};
  a["min"] = {-1, 0, -1};
  a["max"] = {1, 2, 1};
  return accessor;
}

Json interleaved(GlbBuilder& b, const QuadPart& p) {
  std::string data;
  const auto put = [&](float v) { data.append(reinterpret_cast<const char*>(&v), 4); };
  for (size_t i = 0; i < p.positions.size(); ++i) {
    for (int c = 0; c < 3; ++c) put(p.normals[i][c]);
    for (float v : p.uv[i]) put(v);
    for (int c = 0; c < 3; ++c) put(p.positions[i][c]);
  }
  const int view = b.view(data, 32);
  const size_t n = p.positions.size();
  const int position = b.accessor(view, kFloat, "VEC3", n, 20);
  Json& a = b.json["accessors"].back();
  a["min"] = {-1, 0, -1};
  a["max"] = {1, 2, 1};
  const int normal = b.accessor(view, kFloat, "VEC3", n);
  const int uv = b.accessor(view, kFloat, "VEC2", n, 12);
  return {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}};
}

/// Positions as 16-bit and normals as 8-bit normalized integers; uv as unsigned 16-bit. The node
/// restores the positions: y lies between 0 and 2.
Json quantized(GlbBuilder& b, const QuadPart& p) {
  std::vector<int16_t> places;
  std::vector<int8_t> normals;
  std::vector<uint16_t> uv;
  const auto i16 = [](double v) { return static_cast<int16_t>(std::lround(v * 32767)); };
  for (size_t i = 0; i < p.positions.size(); ++i) {
    const Vec3f& v = p.positions[i];
    places.insert(places.end(), {i16(v.x), i16(v.y - 1), i16(v.z), 0});
    for (int c = 0; c < 3; ++c)
      normals.push_back(static_cast<int8_t>(std::lround(p.normals[i][c] * 127)));
    normals.push_back(0);
    for (float t : p.uv[i]) uv.push_back(static_cast<uint16_t>(std::lround(t * 65535)));
  }
  const size_t n = p.positions.size();
  const int position = b.accessor(b.view(bytes_of(places), 8), kI16, "VEC3", n);
  b.json["accessors"].back()["normalized"] = true;
  b.json["accessors"].back()["min"] = {-32767, -32767, -32767};
  b.json["accessors"].back()["max"] = {32767, 32767, 32767};
  const int normal = b.accessor(b.view(bytes_of(normals), 4), kI8, "VEC3", n);
  b.json["accessors"].back()["normalized"] = true;
  const int coordinates = b.accessor(b.view(bytes_of(uv), 4), kU16, "VEC2", n);
  b.json["accessors"].back()["normalized"] = true;
  return {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", coordinates}};
}

// world = R(180 degrees about +Y) S(2) local; exact, without rounding.
QuadPart turned(QuadPart p) {
  for (Vec3f& v : p.positions) v = Vec3f(-v.x, v.y, -v.z) * 0.5f;
  for (Vec3f& n : p.normals) n = {-n.x, n.y, -n.z};
  return p;
}

/// All vertices follow the first joint only.
Json skinned(GlbBuilder& b, Json attributes, size_t vertices) {
  std::vector<float> weights;
  for (size_t i = 0; i < vertices; ++i) weights.insert(weights.end(), {1, 0, 0, 0});
  attributes["JOINTS_0"] =
      b.accessor(b.view(std::string(4 * vertices, '\0')), kU8, "VEC4", vertices);
  attributes["WEIGHTS_0"] = b.floats(weights, 4);
  return attributes;
}

Json attributes_of(GlbBuilder& b, const QuadPart& p, Encoding e) {
  if (e == Encoding::interleaved) return interleaved(b, p);
  if (e == Encoding::quantized) return quantized(b, p);
  const int position =
      e == Encoding::sparse ? sparse_positions(b, p.positions) : b.floats(flat(p.positions, 3), 3);
  const int normal = b.floats(flat(p.normals, 3), 3);
  return {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", b.floats(flat(p.uv), 2)}};
}

Json primitives_of(GlbBuilder& b, const QuadPart& p, Encoding e) {
  const size_t quads = p.positions.size() / 4;
  Json primitive = {{"attributes", attributes_of(b, p, e)}, {"material", p.material}};
  if (e == Encoding::skinned)
    primitive["attributes"] = skinned(b, primitive["attributes"], p.positions.size());
  if (e == Encoding::morphed)  // the target adds the other half of the positions
    primitive["targets"] = Json::array({{{"POSITION", primitive["attributes"]["POSITION"]}}});
  const std::vector<uint32_t> all = triangles(quads, e == Encoding::mirrored);
  Json out = Json::array();
  if (e == Encoding::fans || e == Encoding::many_primitives) {
    for (uint32_t q = 0; q < quads; ++q) {
      const uint32_t i = 4 * q;
      const bool fan = e == Encoding::fans;
      primitive["indices"] = b.indices_u16(
          as<uint16_t>(fan ? std::vector<uint32_t>{i, i + 1, i + 2, i + 3}
                           : std::vector<uint32_t>{i, i + 1, i + 2, i, i + 2, i + 3}));
      primitive["mode"] = fan ? 6 : 4;
      out.push_back(primitive);
    }
    return out;
  }
  if (e == Encoding::strip) {
    std::vector<uint16_t> indices;
    for (uint32_t q = 0; q < quads; ++q) {
      const auto i = static_cast<uint16_t>(4 * q);
      const auto at = [&](int k) { return static_cast<uint16_t>(i + k); };
      if (q > 0) indices.insert(indices.end(), {indices.back(), at(0)});
      indices.insert(indices.end(), {at(0), at(1), at(3), at(2)});
    }
    primitive["indices"] = b.indices_u16(indices);
    primitive["mode"] = 5;
  } else if (e == Encoding::indices_u8) {
    primitive["indices"] = b.indices_u8(as<uint8_t>(all));
  } else if (e == Encoding::indices_u32) {
    primitive["indices"] = b.indices_u32(all);
  } else if (e != Encoding::no_indices) {
    primitive["indices"] = b.indices_u16(as<uint16_t>(all));
  }
  out.push_back(primitive);
  return out;
}

/// The same triangles, each with vertices of its own.
QuadPart unshared(const QuadPart& p) {
  QuadPart out{p.name, p.material, {}, {}, {}};
  for (uint32_t i : triangles(p.positions.size() / 4, false)) {
    out.positions.push_back(p.positions[i]);
    out.normals.push_back(p.normals[i]);
    out.uv.push_back(p.uv[i]);
  }
  return out;
}

QuadPart halved(QuadPart p) {
  for (Vec3f& v : p.positions) v = v * 0.5f;
  return p;
}

QuadPart mirrored(QuadPart p) {
  for (Vec3f& v : p.positions) v.x = -v.x;
  for (Vec3f& n : p.normals) n.x = -n.x;
  return p;
}

// world = T(0.5, -0.25, 0.125) R(90 degrees about +Y) S(2, 0.5, 4) local; R maps z to x and x to
// -z.
QuadPart below_nodes(QuadPart p) {
  for (Vec3f& v : p.positions) {
    const Vec3f t = v - Vec3f(0.5f, -0.25f, 0.125f);
    v = {-t.z / 2, t.y / 0.5f, t.x / 4};
  }
  for (Vec3f& n : p.normals) n = normalize(Vec3f(-n.z * 2, n.y * 0.5f, n.x * 4));
  return p;
}

void place(GlbBuilder& b, int mesh, Encoding e) {
  Json node = {{"mesh", mesh}};
  if (e == Encoding::mirrored) node["scale"] = {-1, 1, 1};
  if (e == Encoding::quantized) node["translation"] = {0, 1, 0};
  if (e == Encoding::instanced)
    node["extensions"][kInstances]["attributes"] = {{"SCALE", b.floats({2, 2, 2}, 3)},
                                                    {"ROTATION", b.floats({0, 1, 0, 0}, 4)}};
  if (e == Encoding::skinned) node.update({{"skin", 0}, {"translation", {7, 8, 9}}});
  if (e == Encoding::morphed) node["weights"] = {1};
  if (e != Encoding::nested && e != Encoding::matrices) {
    b.node(node);
    return;
  }
  const double half = std::sqrt(0.5);
  const bool matrix = e == Encoding::matrices;
  const auto below = [&](Json child, Json parent) {
    b.json["nodes"].push_back(std::move(child));
    parent["children"] = Json::array({b.json["nodes"].size() - 1});
    return parent;
  };
  node.update(matrix ? Json{{"matrix", {2, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 4, 0, 0, 0, 0, 1}}}
                     : Json{{"scale", {2, 0.5, 4}}});
  node = below(node, matrix ? Json{{"matrix", {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1}}}
                            : Json{{"rotation", {0, half, 0, half}}});
  b.node(below(node,
               matrix ? Json{{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5, -0.25, 0.125, 1}}}
                      : Json{{"translation", {0.5, -0.25, 0.125}}}));
}

}  // namespace

const std::vector<NamedEncoding> kEncodings{
    {Encoding::indices_u8, "indices_u8", Same::bits},
    {Encoding::indices_u16, "indices_u16", Same::bits},
    {Encoding::indices_u32, "indices_u32", Same::bits},
    {Encoding::no_indices, "no_indices", Same::bits},
    {Encoding::interleaved, "interleaved", Same::bits},
    {Encoding::sparse, "sparse", Same::bits},
    {Encoding::data_uri, "data_uri", Same::bits},
    {Encoding::external, "external", Same::bits},
    {Encoding::many_primitives, "many_primitives", Same::bits},
    {Encoding::strip, "strip", Same::but_order},
    {Encoding::fans, "fans", Same::but_order},
    {Encoding::mirrored, "mirrored", Same::but_order},
    {Encoding::nested, "nested", Same::but_rounding},
    {Encoding::matrices, "matrices", Same::but_rounding},
    {Encoding::quantized, "quantized", Same::but_rounding},
    {Encoding::instanced, "instanced", Same::bits},
    {Encoding::skinned, "skinned", Same::bits},
    {Encoding::morphed, "morphed", Same::bits},
};

void QuadPart::add(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const Vec3f n(normalize(cross(b - a, c - a)));
  for (const Vec3d& p : {a, b, c, d}) {
    positions.push_back(Vec3f(p));
    normals.push_back(n);
  }
  for (const auto& t : {std::array{0.f, 1.f}, {1.f, 1.f}, {1.f, 0.f}, {0.f, 0.f}}) uv.push_back(t);
}

std::vector<QuadPart> simple_room() {
  QuadPart shell{"shell", kGrey, {}, {}, {}}, red{"red", kRed, {}, {}, {}},
      tiles{"tiles", kTiles, {}, {}, {}}, lamp{"lamp", kLamp, {}, {}, {}},
      block{"block", kGrey, {}, {}, {}};
  shell.add({-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1});
  shell.add({-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1});
  shell.add({1, 0, 1}, {-1, 0, 1}, {-1, 2, 1}, {1, 2, 1});
  shell.add({-1, 0, 1}, {-1, 0, -1}, {-1, 2, -1}, {-1, 2, 1});
  red.add({1, 0, -1}, {1, 0, 1}, {1, 2, 1}, {1, 2, -1});
  tiles.add({-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1});
  lamp.add({-0.5, 1.97, -0.5}, {0.5, 1.97, -0.5}, {0.5, 1.97, 0.5}, {-0.5, 1.97, 0.5});
  const double lo = 0.1, hi = 0.7, y = 0.6;
  block.add({lo, 0.01, 0}, {hi, 0.01, 0}, {hi, y, 0}, {lo, y, 0});
  block.add({lo, 0.01, -0.6}, {lo, 0.01, 0}, {lo, y, 0}, {lo, y, -0.6});
  block.add({hi, 0.01, 0}, {hi, 0.01, -0.6}, {hi, y, -0.6}, {hi, y, 0});
  block.add({lo, y, 0}, {hi, y, 0}, {hi, y, -0.6}, {lo, y, -0.6});
  return {shell, red, tiles, lamp, block};
}

EncodedScene encode(const std::vector<QuadPart>& parts, Encoding e) {
  GlbBuilder b;
  add_materials(b);
  for (const QuadPart& part : parts) {
    const QuadPart p = e == Encoding::no_indices                            ? unshared(part)
                       : e == Encoding::mirrored                            ? mirrored(part)
                       : e == Encoding::instanced || e == Encoding::skinned ? turned(part)
                       : e == Encoding::morphed                             ? halved(part)
                       : e == Encoding::nested || e == Encoding::matrices   ? below_nodes(part)
                                                                            : part;
    b.json["meshes"].push_back({{"name", p.name}, {"primitives", primitives_of(b, p, e)}});
    place(b, static_cast<int>(b.json["meshes"].size()) - 1, e);
  }
  b.camera("camera", {-0.8, 1.3, 0.9}, {0.6, 0.7, -0.6}, 1.1, 4.0 / 3);
  if (e == Encoding::instanced) b.json["extensionsRequired"] = {kInstances};
  if (e == Encoding::skinned) {
    b.node({{"rotation", {0, 1, 0, 0}}, {"scale", {2, 2, 2}}});
    b.json["skins"] = Json::array({{{"joints", {b.json["nodes"].size() - 1}}}});
  }
  if (e == Encoding::quantized) {
    b.json["extensionsUsed"].push_back("KHR_mesh_quantization");
    b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  }
  if (e == Encoding::data_uri) return {"scene.gltf", {{"scene.gltf", b.gltf()}}};
  if (e == Encoding::external) {
    b.json["buffers"] = Json::array({{{"uri", "scene.bin"}, {"byteLength", b.bin.size()}}});
    return {"scene.gltf", {{"scene.gltf", b.json.dump(1)}, {"scene.bin", b.bin}}};
  }
  return {"scene.glb", {{"scene.glb", b.glb()}}};
}

std::vector<NamedScene> encoded_rooms() {
  const auto room = [](const char* name, Encoding e) {
    const EncodedScene scene = encode(simple_room(), e);
    return NamedScene{name, scene.files.at(scene.file)};
  };
  return {room("plain.glb", Encoding::indices_u16), room("instanced.glb", Encoding::instanced),
          room("skinned.glb", Encoding::skinned), room("morphed.glb", Encoding::morphed)};
}

}  // namespace tdpt::testing
