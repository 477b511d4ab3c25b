#include "libcommon/testing/rooms/glossy_rooms.h"

#include <numbers>

#include "libcommon/testing/files/ies_text.h"
#include "libcommon/testing/rooms/room_scene.h"

namespace tdpt::testing {
namespace {

/// Triangles with smooth normals and texture coordinates.
struct Mesh {
  std::vector<float> positions, normals, uv;
  std::vector<uint16_t> indices;

  void vertex(const Vec3d& p, const Vec3d& n, double u, double v) {
    for (int c = 0; c < 3; ++c) {
      positions.push_back(static_cast<float>(p[c]));
      normals.push_back(static_cast<float>(n[c]));
    }
    uv.push_back(static_cast<float>(u));
    uv.push_back(static_cast<float>(v));
  }
  void triangle(size_t a, size_t b, size_t c) {
    for (size_t i : {a, b, c}) indices.push_back(static_cast<uint16_t>(i));
  }
};

void add(RoomScene& s, const std::string& name, int material, const Mesh& m) {
  const int position = s.b.floats(m.positions, 3), normal = s.b.floats(m.normals, 3);
  const int uv = s.b.floats(m.uv, 2);
  Json primitive = {
      {"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}}},
      {"indices", s.b.indices_u16(m.indices)},
      {"material", material}};
  s.b.node({{"name", name}, {"mesh", s.b.mesh(primitive, name)}});
}

/// Watertight: the poles and the seam share vertices exactly. 12 x 6 facets.
Mesh sphere(const Vec3d& centre, double radius) {
  constexpr int kAround = 12, kDown = 6;
  Mesh m;
  for (int i = 0; i <= kDown; ++i)
    for (int j = 0; j <= kAround; ++j) {
      const double t = std::numbers::pi * i / kDown,
                   p = 2 * std::numbers::pi * (j % kAround) / kAround;
      const double s = i == 0 || i == kDown ? 0 : std::sin(t);
      const Vec3d n(s * std::cos(p), std::cos(t), -s * std::sin(p));
      m.vertex(centre + n * radius, n, static_cast<double>(j) / kAround,
               static_cast<double>(i) / kDown);
    }
  for (int i = 0; i < kDown; ++i)
    for (int j = 0; j < kAround; ++j) {
      const auto a = static_cast<size_t>(i * (kAround + 1) + j), b = a + kAround + 1;
      if (i > 0) m.triangle(a, b, a + 1);
      if (i < kDown - 1) m.triangle(a + 1, b, b + 1);
    }
  return m;
}

/// One quad a, a+u, a+u+v, a+v, facing along cross(u, v); the texture upright.
Mesh panel(const Vec3d& a, const Vec3d& u, const Vec3d& v) {
  Mesh m;
  const Vec3d n = normalize(cross(u, v));
  m.vertex(a, n, 0, 1);
  m.vertex(a + u, n, 1, 1);
  m.vertex(a + u + v, n, 1, 0);
  m.vertex(a + v, n, 0, 0);
  m.triangle(0, 1, 2);
  m.triangle(0, 2, 3);
  return m;
}

/// Box of the given corners with flat normals and texture coordinates on every face.
Mesh box(const Vec3d& lo, const Vec3d& hi) {
  const Vec3d d = hi - lo, x{d.x, 0, 0}, y{0, d.y, 0}, z{0, 0, d.z};
  Mesh m;
  for (const Mesh& face :
       {panel(lo + z, x, y), panel(lo + x, x * -1.0, y), panel(lo, z, y),
        panel(hi - y, z * -1.0, y), panel(lo + y + z, x, z * -1.0), panel(lo, x, z)}) {
    const size_t first = m.positions.size() / 3;
    m.positions.insert(m.positions.end(), face.positions.begin(), face.positions.end());
    m.normals.insert(m.normals.end(), face.normals.begin(), face.normals.end());
    m.uv.insert(m.uv.end(), face.uv.begin(), face.uv.end());
    m.triangle(first, first + 1, first + 2);
    m.triangle(first, first + 2, first + 3);
  }
  return m;
}

/// An n x n texture, each texel given by `texel(x, y, channel)`.
template <class Texel>
int picture(RoomScene& s, int n, Json sampler, Texel texel) {
  std::string texels;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      for (int c = 0; c < 4; ++c) texels += static_cast<char>(texel(x, y, c));
  return s.b.texture(png_of(n, n, texels), std::move(sampler));
}

const Json kNearest = {{"magFilter", 9728}, {"minFilter", 9728}};
const Json kLinear = {{"magFilter", 9729}, {"minFilter", 9729}};

int material(RoomScene& s, const std::string& name, std::array<double, 3> colour, double metallic,
             double roughness, Json more = {}) {
  Json m = {{"name", name},
            {"pbrMetallicRoughness",
             {{"baseColorFactor", {colour[0], colour[1], colour[2], 1}},
              {"metallicFactor", metallic},
              {"roughnessFactor", roughness}}}};
  if (!more.is_null()) m.update(more);
  if (!m.contains("extensions")) m["doubleSided"] = true;  // solids have an inside
  return s.b.material(m);
}

Json glass(Json volume) {
  return {{"extensions",
           {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
            {"KHR_materials_ior", {{"ior", 1.5}}},
            {"KHR_materials_volume", std::move(volume)}}}};
}

Json without_specular() {
  return {{"KHR_materials_specular", {{"specularFactor", 0}}}};
}

void add_textured_block(RoomScene& s, bool coated) {
  const int colour = picture(s, 8, kLinear, [](int x, int y, int c) {
    return c == 3 ? 255 : 60 + (x * 97 + y * 61 + c * 40 + x * y * 29) % 190;
  });
  const int rough = picture(s, 4, kLinear, [](int x, int y, int c) {
    return c == 1 ? 110 + 40 * ((x + y) % 4) : c == 2 ? 255 * ((x / 2 + y / 2) % 2) : 255;
  });
  const int bumps = picture(s, 8, kLinear, [](int x, int y, int c) {
    return c == 0   ? 128 + ((x % 4) - 2) * 20
           : c == 1 ? 128 + ((y % 4) - 2) * 20
           : c == 2 ? 240
                    : 255;
  });
  Json tiles = {{"name", "tiles"},
                {"pbrMetallicRoughness",
                 {{"baseColorTexture", {{"index", colour}}},
                  {"metallicRoughnessTexture", {{"index", rough}}}}},
                {"normalTexture", {{"index", bumps}}},
                {"doubleSided", true}};
  if (coated)
    tiles["extensions"]["KHR_materials_clearcoat"] = {{"clearcoatFactor", 1},
                                                      {"clearcoatTexture", {{"index", colour}}}};
  const int block = s.b.material(tiles);
  add(s, "tiles", block, box({0.9, 0.01, -0.75}, {1.5, 0.6, -0.25}));
}

void add_coated_balls(RoomScene& s) {
  for (const char* e : {"clearcoat", "sheen"})
    s.b.json["extensionsUsed"].push_back(std::string("KHR_materials_") + e);
  const Json car = {{"doubleSided", true},
                    {"extensions",
                     {{"KHR_materials_clearcoat",
                       {{"clearcoatFactor", 0.8}, {"clearcoatRoughnessFactor", 0.35}}}}}};
  add(s, "car", material(s, "car", {0.7, 0.2, 0.2}, 0.8, 0.5, car), sphere({1.5, 0.35, 0.4}, 0.3));
  Json cloth = {{"doubleSided", true}, {"extensions", without_specular()}};
  cloth["extensions"]["KHR_materials_sheen"] = {{"sheenColorFactor", {0.9, 0.8, 0.7}},
                                                {"sheenRoughnessFactor", 0.4}};
  add(s, "cloth", material(s, "cloth", {0.4, 0.1, 0.1}, 0, 1, cloth), sphere({0.6, 0.3, 0}, 0.28));
}

void add_sheet(RoomScene& s, bool mask) {
  const int holes = picture(s, 8, kNearest, [mask](int x, int y, int c) {
    if (c < 3) return 170 + 20 * c;
    return mask ? ((x + y) % 2 ? 255 : 0) : 60 + 16 * x;
  });
  Json m = {
      {"name", "sheet"},
      {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", holes}}}, {"metallicFactor", 0}}},
      {"alphaMode", mask ? "MASK" : "BLEND"},
      {"extensions", without_specular()},
      {"doubleSided", true}};
  add(s, "sheet", s.b.material(m), panel({1.8, 0.4, -0.7}, {0, 0, 1.4}, {0, 1.2, 0}));
}

/// Frosted, without volume: light goes straight on, only scattered by the roughness.
void add_pane(RoomScene& s) {
  s.b.json["extensionsUsed"].push_back("KHR_materials_transmission");
  add(s, "pane",
      s.b.material({{"name", "pane"},
                    {"pbrMetallicRoughness",
                     {{"baseColorFactor", {0.9, 0.9, 1, 1}},
                      {"metallicFactor", 0},
                      {"roughnessFactor", 0.5}}},
                    {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.8}}}}},
                    {"doubleSided", true}}),
      panel({1.8, 0.4, -0.7}, {0, 0, 1.4}, {0, 1.2, 0}));
}

void add_punctual(RoomScene& s, GlossyRooms::Light kind) {
  using Light = GlossyRooms::Light;
  Json light = {{"color", {1, 0.9, 0.8}}, {"intensity", kind == Light::sun ? 20 : 12}};
  light["type"] = kind == Light::point ? "point" : kind == Light::spot ? "spot" : "directional";
  if (kind == Light::spot) light["spot"] = {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.9}};
  const char* extension = "KHR_lights_punctual";
  if (kind == Light::luminaire) {
    extension = "EXT_lights_ies";
    const IesText profile{.vertical = {0, 20, 40, 70, 110},
                          .horizontal = {0, 60, 130, 200, 290},
                          .candela = {12, 11, 8,  3, 1, 12, 9, 4,  1, 0, 12, 6, 9,
                                      4,  2,  12, 7, 3, 1,  0, 12, 9, 8, 8,  0}};
    light = {{"bufferView", s.b.view(profile.text())}, {"mimeType", "application/x-ies-lm-63"}};
  }
  s.b.json["extensionsUsed"].push_back(extension);
  s.b.json["extensions"][extension]["lights"] = Json::array({light});
  // Lights shine along -z of their node. The spot points straight down, tilted by 20 degrees
  // towards the window; the sun shines into the second room's open end, 25 degrees downwards.
  Json node = {{"name", "light"},
               {"translation", {3.3, 1.5, 0.2}},
               {"extensions", {{extension, {{"light", 0}}}}}};
  const auto towards = [&](const Vec3d& w) {
    const double yaw = std::atan2(-w.x, -w.z), pitch = std::asin(w.y / length(w));
    node["rotation"] = {
        std::cos(yaw / 2) * std::sin(pitch / 2), std::sin(yaw / 2) * std::cos(pitch / 2),
        -std::sin(yaw / 2) * std::sin(pitch / 2), std::cos(yaw / 2) * std::cos(pitch / 2)};
  };
  if (kind == Light::spot || kind == Light::luminaire) towards({-0.34, -0.94, 0.05});
  if (kind == Light::sun) towards({-0.9, -0.42, 0.1});
  s.b.node(node);
}

void add_light(RoomScene& s, GlossyRooms::Light kind) {
  using Light = GlossyRooms::Light;
  if (kind == Light::lamp) return s.ceiling_lamp(3.1, 4, 0.8);
  if (kind != Light::textured_lamp && kind != Light::mirror_lamp) return add_punctual(s, kind);
  const int colours = picture(s, 4, kLinear, [](int x, int y, int c) {
    return c == 3 ? 255 - 40 * x : 20 + (x * 83 + y * 131 + c * 57) % 235;
  });
  if (kind == Light::mirror_lamp) {
    const int sheen = s.b.material(
        {{"name", "sheen"},
         {"pbrMetallicRoughness",
          {{"baseColorTexture", {{"index", colours}}}, {"roughnessFactor", 0}}},
         {"emissiveFactor", {1, 0.9, 0.8}},
         {"emissiveTexture", {{"index", colours}}},
         {"alphaMode", "BLEND"},
         {"doubleSided", true},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}});
    return add(s, "sheen", sheen, panel({2.3, 1.2, -0.8}, {1.6, 0.3, 0}, {0, 0, 1.6}));
  }
  const int lamp = s.b.material(
      {{"name", "screen"},
       {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}, {"metallicFactor", 0}}},
       {"emissiveFactor", {1, 1, 1}},
       {"emissiveTexture", {{"index", colours}}},
       {"extensions",
        {{"KHR_materials_specular", {{"specularFactor", 0}}},
         {"KHR_materials_emissive_strength", {{"emissiveStrength", 10}}}}}});
  add(s, "screen", lamp, panel({2.3, 1.98, -0.8}, {1.6, 0, 0}, {0, 0, 1.6}));
}

}  // namespace

std::string glossy_rooms(const GlossyRooms& what) {
  RoomScene s;
  const int grey = s.diffuse("grey", 0.7, 0.7, 0.7);
  RoomScene::Walls walls{grey, grey, s.diffuse("red", 0.65, 0.5, 0.5),
                         s.diffuse("green", 0.5, 0.65, 0.5), what.light == GlossyRooms::Light::sun};
  if (what.plastic_floor) walls.floor = material(s, "plastic", {0.3, 0.4, 0.6}, 0, 0.3);
  if (what.metal_walls) walls.back = material(s, "metal", {0.9, 0.75, 0.5}, 1, 0.45);
  s.row(2, {0.5, 1.5, -0.5, 0.5}, walls);
  if (what.mirror)
    add(s, "mirror", material(s, "mirror", {0.95, 0.95, 0.95}, 1, 0),
        panel({1.6, 0.5, 0.98}, {-1, 0, 0}, {0, 1, 0}));
  if (what.glass) {
    for (const char* e : {"transmission", "ior", "volume"})
      s.b.json["extensionsUsed"].push_back(std::string("KHR_materials_") + e);
    add(s, "slab", material(s, "glass", {1, 1, 1}, 0, 0, glass({{"thicknessFactor", 1}})),
        box({0.9, 0.3, -0.6}, {1.1, 1.2, 0.1}));
    add(s, "frosted",
        material(s, "frosted", {0.9, 1, 0.95}, 0, 0.5,
                 glass({{"thicknessFactor", 1},
                        {"attenuationDistance", 0.5},
                        {"attenuationColor", {0.5, 0.9, 0.7}}})),
        sphere({1.45, 0.4, 0.35}, 0.3));
  }
  if (what.smooth) {
    add(s, "ball", material(s, "ball", {0.7, 0.3, 0.3}, 0, 0.25), sphere({1.3, 0.4, -0.4}, 0.35));
    add(s, "chalk",
        material(s, "chalk", {0.7, 0.7, 0.6}, 0, 1,
                 {{"extensions", without_specular()}, {"doubleSided", true}}),
        sphere({1.5, 0.3, 0.45}, 0.28));
  }
  if (what.textures || what.coats) add_textured_block(s, what.coats);
  if (what.coats) add_coated_balls(s);
  if (what.screen || what.veil) add_sheet(s, what.screen);
  if (what.pane) add_pane(s);
  add_light(s, what.light);
  s.b.camera("camera", {0.15, 1.25, 0.75}, {2, 0.8, -0.25}, kFov, kAspect);
  return s.b.glb();
}

}  // namespace tdpt::testing
