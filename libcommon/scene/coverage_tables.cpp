#include "libcommon/scene/coverage_tables.h"

#include <algorithm>
#include <cmath>

namespace tdpt {
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
