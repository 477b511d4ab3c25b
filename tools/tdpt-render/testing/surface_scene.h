// Test only: a heap of triangles with random materials, textures and corners, which covers every
// feature of surfaces.
#pragma once
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"

namespace tdpt::test {

class SurfaceHeap {
 public:
  static constexpr uint32_t kMaterials = 96, kTriangles = 4 * kMaterials;

  /// uv lie within `reach` of 0.
  explicit SurfaceHeap(double reach = 3) {
    for (int i = 0; i < 3; ++i) add_image(i);
    for (uint32_t i = 0; i < kMaterials; ++i) scene_.materials.push_back(material(i));
    for (uint32_t i = 0; i < kTriangles; ++i) add_triangle(i, reach);
    scene_.cameras.resize(1);
    Camera& camera = scene_.cameras[0];
    camera.position = {0, 0, 3}, camera.right = {1, 0, 0}, camera.up = {0, 1, 0};
    camera.forward = {0, 0, -1};
  }
  const Scene& scene() const { return scene_; }

 private:
  double unit() { return rng_.uniform(); }
  float unit_float() { return rng_.uniform_float(); }
  bool chance(double p) { return unit() < p; }
  double within(double reach) { return reach * (2 * unit() - 1); }
  Rgb colour() {
    const float r = unit_float();
    const float g = unit_float();
    return {r, g, unit_float()};
  }
  Vec3d direction() {
    Vec3d d;
    do {
      for (int c = 0; c < 3; ++c) d[c] = within(1);
    } while (dot(d, d) > 1 || dot(d, d) < 0.01);
    return normalize(d);
  }

  void add_image(int i) {
    Image image{4 + 3 * i, 5 + i, {}};
    for (int t = 0; t < 4 * image.width * image.height; ++t)
      image.texels.push_back(static_cast<uint8_t>(256 * unit()));
    scene_.images.push_back(image);
  }

  TextureMap map(double p, bool srgb = false) {
    TextureMap m;
    if (!chance(p)) return m;
    m.image = static_cast<int32_t>(3 * unit());
    m.srgb = srgb;
    m.nearest = chance(0.2);
    m.wrap_u = static_cast<TextureMap::Wrap>(3 * unit());
    m.wrap_v = static_cast<TextureMap::Wrap>(3 * unit());
    m.uv_set = chance(0.5) ? 1 : 0;
    if (chance(0.5))
      for (float& t : m.transform) t += static_cast<float>(within(1));
    return m;
  }

  Material material(uint32_t i) {
    Material m;
    m.base_color = colour();
    if (chance(0.2)) m.emission = colour() * 50.0f;
    m.double_sided = chance(0.5);
    m.plain = i % 6 == 0;
    if (m.plain) return m;
    if (i % 6 == 1) return pane(m);
    m.metallic = chance(0.3) ? unit_float() : 0;
    if (m.metallic > 0 && chance(0.5)) m.dip = colour() * 4.0f;
    m.roughness = chance(0.2) ? 0 : unit_float();
    m.ior = chance(0.2) ? 1.0f : 1 + unit_float();
    m.specular = unit_float();
    m.specular_color = colour();
    m.solid = chance(0.5);
    if (m.solid) m.absorption = colour();
    if (chance(0.4)) m.transmission = unit_float();
    if (chance(0.4)) m.sheen_color = colour(), m.sheen_roughness = unit_float();
    if (chance(0.4)) m.coat = unit_float(), m.coat_roughness = chance(0.3) ? 0 : unit_float();
    m.normal_scale = m.coat_normal_scale = 0.5f;
    if (chance(0.3)) add_alpha(m);
    add_maps(m);
    return m;
  }
  Material pane(Material m) {
    m.emission = {};
    m.base_color = Rgb(unit_float());
    m.specular = 1;
    m.roughness = 0;
    m.transmission = 0.5f + 0.5f * unit_float();
    return m;
  }
  void add_alpha(Material& m) {
    m.alpha_mode = chance(0.5) ? Material::Alpha::mask : Material::Alpha::blend;
    m.alpha = 0.5f + 0.5f * unit_float();
    m.alpha_cutoff = 0.3f;
  }
  void add_maps(Material& m) {
    m.maps[MAP_BASE] = map(0.5, true);
    m.maps[MAP_METALLIC_ROUGHNESS] = map(0.4);
    m.maps[MAP_EMISSION] = map(0.5, true);
    m.maps[MAP_NORMAL] = map(0.4);
    m.maps[MAP_SPECULAR] = map(0.3);
    m.maps[MAP_SPECULAR_COLOR] = map(0.3, true);
    m.maps[MAP_TRANSMISSION] = map(0.3);
    m.maps[MAP_COAT] = map(0.3);
    m.maps[MAP_COAT_ROUGHNESS] = map(0.3);
    m.maps[MAP_COAT_NORMAL] = map(0.3);
    m.maps[MAP_SHEEN_COLOR] = map(0.3, true);
    m.maps[MAP_SHEEN_ROUGHNESS] = map(0.3);
  }

  void add_triangle(uint32_t i, double reach) {
    const auto first = static_cast<uint32_t>(scene_.positions.size());
    const Vec3d corner = direction() * 0.5;
    const Vec3d e1 = direction() * 0.2;
    const Vec3d e2 = normalize(cross(e1, direction())) * 0.2 + e1 * 0.3;
    const Vec3d normal = normalize(cross(e1, e2));
    const bool tangents = chance(0.5);
    const auto how = static_cast<uint8_t>(3 * unit());
    for (const Vec3d& p : {corner, corner + e1, corner + e2}) {
      scene_.positions.push_back(Vec3f(p));
      const Vec3d n = normalize(normal * (how == 2 ? -1.0 : 1.0) + direction() * 0.4);
      scene_.normals.push_back(how == 0 ? Vec3f() : Vec3f(n));
      const Vec3f t(direction());
      scene_.tangents.push_back(tangents ? std::array{t.x, t.y, t.z, i % 2 ? 1.0f : -1.0f}
                                         : std::array<float, 4>{});
      for (auto& uv : scene_.uv) {
        const auto u = static_cast<float>(within(reach));
        uv.push_back({u, static_cast<float>(within(reach))});
      }
      const Rgb c = colour();
      scene_.colours.push_back({c.x, c.y, c.z, 0.5f + 0.5f * unit_float()});
    }
    scene_.smooth.push_back(how);
    scene_.triangles.push_back({{first, first + 1, first + 2}, i % kMaterials});
  }

  Rng rng_{17, 4, 0};
  Scene scene_;
};

}  // namespace tdpt::test
