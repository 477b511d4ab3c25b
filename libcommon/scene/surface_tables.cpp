#include "libcommon/scene/surface_tables.h"

#include <algorithm>
#include <cmath>

#include "libcommon/scene/pane.h"

namespace tdpt {
namespace {

// Not a valid coordinate, but squared differences stay finite.
constexpr float kNoCoordinate = 1e15f;

float coordinate(float u) {
  return std::abs(u) < kNoCoordinate ? u : kNoCoordinate;
}
float finite(float x) {
  return std::isfinite(x) ? x : 0.0f;
}

class Builder {
 public:
  Builder(const Scene& scene, double radiance_unit)
      : scene_(scene), per_unit_(1 / radiance_unit), words_(scene) {}

  SurfaceTables build() {
    for (const Material& m : scene_.materials) {
      tables_.materials.push_back(material(m));
      note_features(m);
    }
    add_faces();
    SurfaceFeatures& f = tables_.features;
    f.normals = !scene_.smooth.empty();
    f.layers = f.layers || f.normals;
    f.textures = !tables_.maps.empty();
    f.colours = f.layers && !scene_.colours.empty();
    if (f.normals || f.textures || f.colours) add_corners();
    tables_.coverage = make_coverages(scene_, words_);
    f.coverage = !tables_.coverage.coverages.empty();
    f.coverage_textures = tables_.coverage.textured();
    tables_.texel_words = std::move(words_.words);
    return std::move(tables_);
  }

 private:
  uint32_t map(const TextureMap& map) {
    if (!map) return shader::kNoMap;
    const auto& t = map.transform;
    shader::SurfaceMap record{};
    record.grid = words_.grid_of(map);
    record.uv_set = map.uv_set;
    record.u_of_u = finite(t[0]), record.u_of_v = finite(t[1]), record.u_shift = finite(t[2]);
    record.v_of_u = finite(t[3]), record.v_of_v = finite(t[4]), record.v_shift = finite(t[5]);
    tables_.maps.push_back(record);
    return static_cast<uint32_t>(tables_.maps.size() - 1);
  }

  shader::SurfaceMaterial material(const Material& m) {
    shader::SurfaceMaterial r = surface_material(m);
    r.emission = Rgb(Vec3d(m.emission) * per_unit_);
    add_maps(m, r);
    return r;
  }
  void add_maps(const Material& m, shader::SurfaceMaterial& r) {
    const bool bends = m.maps[MAP_NORMAL] || m.maps[MAP_COAT_NORMAL];
    if (bends && !m.plain) r.flags |= MATERIAL_BENDS;
    for (const TextureMap& map : m.maps)
      tables_.material_maps.push_back(m.plain ? shader::kNoMap : this->map(map));
  }

  void note_features(const Material& m) {
    SurfaceFeatures& f = tables_.features;
    f.layers = f.layers || !m.plain;
    f.coats = f.coats || m.coat > 0;
    f.sheen = f.sheen || m.sheened();
    const bool pane = static_cast<bool>(pane_of(m));
    f.panes = f.panes || pane;
    f.transmission = f.transmission || (m.transmission > 0 && !pane);
    f.absorption = f.absorption || (m.solid && max_component(m.absorption) > 0);
  }

  void add_faces() {
    tables_.faces.reserve(scene_.triangles.size());
    for (uint32_t t = 0; t < scene_.triangles.size(); ++t) {
      const TriangleShape s = shape_of(scene_, t);
      shader::Face face{};
      face.p0 = scene_.vertex(t, 0);
      face.e1 = Vec3f(s.e1), face.e2 = Vec3f(s.e2);
      face.normal = Vec3f(s.normal);
      face.material = scene_.triangles[t].material;
      face.smoothed = scene_.smooth.empty() ? 0u : scene_.smooth[t];
      tables_.faces.push_back(face);
    }
  }

  void add_corners() {
    for (const Triangle& t : scene_.triangles)
      tables_.face_corners.push_back({t.vertex[0], t.vertex[1], t.vertex[2], 0});
    tables_.corner_attributes.reserve(scene_.positions.size());
    for (size_t i = 0; i < scene_.positions.size(); ++i)
      tables_.corner_attributes.push_back(attributes(i));
  }
  shader::CornerAttributes attributes(size_t i) const {
    shader::CornerAttributes a{};
    a.handedness = 1;
    a.color = Rgb(1.0f), a.alpha = 1;
    if (!scene_.normals.empty()) a.normal = scene_.normals[i];
    if (!scene_.tangents.empty()) {
      const auto& t = scene_.tangents[i];
      a.tangent = {t[0], t[1], t[2]}, a.handedness = t[3];
    }
    if (!scene_.colours.empty()) {
      const auto& c = scene_.colours[i];
      a.color = {c[0], c[1], c[2]}, a.alpha = c[3];
    }
    const auto& [first, second] = scene_.uv;
    if (!first.empty()) a.u0 = coordinate(first[i][0]), a.v0 = coordinate(first[i][1]);
    if (!second.empty()) a.u1 = coordinate(second[i][0]), a.v1 = coordinate(second[i][1]);
    return a;
  }

  const Scene& scene_;
  const double per_unit_;
  TexelWords words_;
  SurfaceTables tables_;
};

}  // namespace

shader::SurfaceMaterial surface_material(const Material& m) {
  shader::SurfaceMaterial r = m;
  const bool emits = m.emission.x + m.emission.y + m.emission.z > 0;
  const bool absorbs = m.solid && max_component(m.absorption) > 0;
  r.flags = (m.plain ? MATERIAL_PLAIN : 0u) | (emits ? MATERIAL_EMITS : 0u) |
            (m.double_sided ? MATERIAL_DOUBLE_SIDED : 0u) | (m.solid ? MATERIAL_SOLID : 0u) |
            (m.glossy_map ? MATERIAL_GLOSSY_MAP : 0u) | (absorbs ? MATERIAL_ABSORBS : 0u);
  if (const Pane pane = pane_of(m))
    r.pane_share = pane.share, r.pane_f0 = pane.f0, r.pane_f90 = pane.f90;
  return r;
}

SurfaceTables make_surfaces(const Scene& scene, double radiance_unit) {
  return Builder(scene, radiance_unit).build();
}

}  // namespace tdpt
