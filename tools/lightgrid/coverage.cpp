#include "tools/lightgrid/coverage.h"

#include <cmath>
#include <map>

namespace tdpt {
namespace {

// Coordinates that count as 0, see texture.h.
float texture_coordinate(double u) {
  return std::abs(u) < 1e9 ? static_cast<float>(u) : 0.0f;
}

uint32_t how_of(const TextureMap& map) {
  using Wrap = TextureMap::Wrap;
  return (map.nearest ? COVERAGE_NEAREST : 0u) |
         (map.wrap_u == Wrap::mirror ? COVERAGE_MIRROR_U : 0u) |
         (map.wrap_u == Wrap::clamp ? COVERAGE_CLAMP_U : 0u) |
         (map.wrap_v == Wrap::mirror ? COVERAGE_MIRROR_V : 0u) |
         (map.wrap_v == Wrap::clamp ? COVERAGE_CLAMP_V : 0u);
}

class Builder {
 public:
  explicit Builder(const Scene& scene) : scene_(scene) {}

  shader::Coverage coverage_of(uint32_t triangle) {
    const Material& m = scene_.material_of(triangle);
    const Triangle& t = scene_.triangles[triangle];
    shader::Coverage v{};
    float alpha[3], u[3] = {}, w[3] = {};
    for (size_t c = 0; c < 3; ++c) {
      const bool coloured = !m.plain && !scene_.colours.empty();
      alpha[c] = m.alpha * (coloured ? scene_.colours[t.vertex[c]][3] : 1.0f);
      const auto& uv = scene_.uv[m.base_map.uv_set];
      if (!m.base_map || m.plain) continue;
      const auto at = uv.empty() ? std::array<float, 2>{} : uv[t.vertex[c]];
      const auto& map = m.base_map.transform;
      u[c] = texture_coordinate(double{map[0]} * at[0] + double{map[1]} * at[1] + map[2]);
      w[c] = texture_coordinate(double{map[3]} * at[0] + double{map[4]} * at[1] + map[5]);
    }
    v.alpha0 = alpha[0], v.alpha1 = alpha[1], v.alpha2 = alpha[2];
    v.u0 = u[0], v.u1 = u[1], v.u2 = u[2];
    v.v0 = w[0], v.v1 = w[1], v.v2 = w[2];
    v.cutoff = m.alpha_mode == Material::Alpha::mask ? m.alpha_cutoff : -1.0f;
    if (m.base_map && !m.plain) {
      const Image& image = scene_.images[static_cast<size_t>(m.base_map.image)];
      v.first = first_texel(m.base_map.image, image);
      v.width = static_cast<uint32_t>(image.width);
      v.height = static_cast<uint32_t>(image.height);
      v.how = how_of(m.base_map);
    }
    return v;
  }

  std::vector<float> texels;

 private:
  uint32_t first_texel(int32_t number, const Image& image) {
    const auto [it, fresh] = first_.try_emplace(number, static_cast<uint32_t>(texels.size()));
    if (fresh)
      for (size_t i = 3; i < image.texels.size(); i += 4)
        texels.push_back(static_cast<float>(image.texels[i]) / 255.0f);
    return it->second;
  }

  const Scene& scene_;
  std::map<int32_t, uint32_t> first_;
};

}  // namespace

CoverageTables make_coverages(const Scene& scene) {
  CoverageTables tables;
  Builder builder(scene);
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    if (scene.material_of(t).alpha_mode == Material::Alpha::opaque) continue;
    if (tables.coverage_of.empty()) tables.coverage_of.resize(scene.triangles.size(), 0);
    tables.coverage_of[t] = static_cast<uint32_t>(tables.coverages.size());
    tables.coverages.push_back(builder.coverage_of(t));
  }
  tables.texels = std::move(builder.texels);
  return tables;
}

}  // namespace tdpt
