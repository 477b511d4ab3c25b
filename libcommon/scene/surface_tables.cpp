#include "libcommon/scene/surface_tables.h"

#include <algorithm>
#include <cmath>

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
      shader::SurfaceMaterial& r = tables_.materials.emplace_back(surface_material(m));
      r.emission = Rgb(Vec3d(m.emission) * per_unit_);
      const bool bends = m.maps[MAP_NORMAL] || m.maps[MAP_COAT_NORMAL];
      if (bends && !m.plain) r.flags |= MATERIAL_BENDS;
      for (const TextureMap& map : m.maps)
        tables_.material_maps.push_back(m.plain ? shader::kNoMap : this->map(map));
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

  void note_features(const Material& m) {
    SurfaceFeatures& f = tables_.features;
    const bool pane = static_cast<bool>(pane_of(m));
    f.layers |= !m.plain;
    f.coats |= m.coat > 0;
    f.sheen |= m.sheened();
    f.panes |= pane;
    f.transmission |= m.transmission > 0 && !pane;
    f.absorption |= m.solid && max_component(m.absorption) > 0;
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

namespace {

uint32_t how_of(const TextureMap& map) {
  using Wrap = TextureMap::Wrap;
  return (map.nearest ? TEXELS_NEAREST : 0u) | (map.wrap_u == Wrap::mirror ? TEXELS_MIRROR_U : 0u) |
         (map.wrap_u == Wrap::clamp ? TEXELS_CLAMP_U : 0u) |
         (map.wrap_v == Wrap::mirror ? TEXELS_MIRROR_V : 0u) |
         (map.wrap_v == Wrap::clamp ? TEXELS_CLAMP_V : 0u) | (map.srgb ? TEXELS_SRGB : 0u);
}

// Coordinates of the corners along one axis, minus whole images, which would cost floats precision.
std::array<float, 3> reduced(const std::array<double, 3>& u, bool clamps) {
  const bool far = !(std::abs(u[0]) < 1e9);
  const double whole = clamps || far ? 0.0 : 2 * std::floor(0.5 * u[0]);
  return {texture_coordinate(u[0] - whole), texture_coordinate(u[1] - whole),
          texture_coordinate(u[2] - whole)};
}

void add_texture(const Scene& scene, const Triangle& t, const TextureMap& map, TexelWords& words,
                 shader::Coverage& v) {
  const auto& uv = scene.uv[map.uv_set];
  std::array<double, 3> u{}, w{};
  for (size_t c = 0; c < 3; ++c) {
    const auto at = uv.empty() ? std::array<float, 2>{} : uv[t.vertex[c]];
    const auto& m = map.transform;
    u[c] = double{m[0]} * at[0] + double{m[1]} * at[1] + m[2];
    w[c] = double{m[3]} * at[0] + double{m[4]} * at[1] + m[5];
  }
  const auto us = reduced(u, map.wrap_u == TextureMap::Wrap::clamp);
  const auto ws = reduced(w, map.wrap_v == TextureMap::Wrap::clamp);
  v.u0 = us[0], v.u1 = us[1], v.u2 = us[2];
  v.v0 = ws[0], v.v1 = ws[1], v.v2 = ws[2];
  v.grid = words.grid_of(map);
}

shader::Coverage coverage_of(const Scene& scene, uint32_t triangle, TexelWords& words) {
  const Material& m = scene.material_of(triangle);
  const Triangle& t = scene.triangles[triangle];
  const bool coloured = !m.plain && !scene.colours.empty();
  const auto alpha = [&](size_t corner) {
    return m.alpha * (coloured ? scene.colours[t.vertex[corner]][3] : 1.0f);
  };
  shader::Coverage v{};
  v.alpha0 = alpha(0), v.alpha1 = alpha(1), v.alpha2 = alpha(2);
  v.cutoff = m.alpha_mode == Material::Alpha::mask ? m.alpha_cutoff : -1.0f;
  if (m.maps[MAP_BASE] && !m.plain) add_texture(scene, t, m.maps[MAP_BASE], words, v);
  return v;
}

}  // namespace

float texture_coordinate(double u) {
  return std::abs(u) < 1e9 ? static_cast<float>(u) : 0.0f;
}

shader::TexelGrid TexelWords::grid_of(const TextureMap& map) {
  const Image& image = scene_.images[static_cast<size_t>(map.image)];
  const auto [it, fresh] = first_.try_emplace(map.image, static_cast<uint32_t>(words.size()));
  if (fresh)
    for (size_t i = 0; i < image.texels.size(); i += 4)
      words.push_back(uint32_t{image.texels[i]} | uint32_t{image.texels[i + 1]} << 8 |
                      uint32_t{image.texels[i + 2]} << 16 | uint32_t{image.texels[i + 3]} << 24);
  return {it->second, static_cast<uint32_t>(image.width), static_cast<uint32_t>(image.height),
          how_of(map)};
}

bool CoverageTables::textured() const {
  return std::any_of(coverages.begin(), coverages.end(),
                     [](const shader::Coverage& v) { return v.grid.width > 0; });
}

CoverageTables make_coverages(const Scene& scene, TexelWords& words) {
  CoverageTables tables;
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    if (scene.material_of(t).alpha_mode == Material::Alpha::opaque) continue;
    if (tables.coverage_of.empty())
      tables.coverage_of.resize(scene.triangles.size(), shader::kNoCoverage);
    tables.coverage_of[t] = static_cast<uint32_t>(tables.coverages.size());
    tables.coverages.push_back(coverage_of(scene, t, words));
  }
  return tables;
}

CoverageTables make_coverages(const Scene& scene) {
  TexelWords words(scene);
  CoverageTables tables = make_coverages(scene, words);
  tables.texels = std::move(words.words);
  return tables;
}

}  // namespace tdpt
