// Evaluates textures, vertex colours and vertex normals at a point of a triangle. Only materials
// that are not `plain` need it; the shading normal also matters where Scene::smooth says so. Any
// texture coordinates are accepted: NaN, and anything beyond 1e9 images, counts as 0.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include "libcommon/scene/scene.h"
#include "shaders/shared/path/surface_layout.h"

namespace tdpt {

/// A point on a triangle: barycentrics of vertices 1 and 2.
struct SurfacePlace {
  uint32_t triangle;
  double b1, b2;
};

/// Texel at a point, linear RGBA in [0,1]; 1 if the map has no image.
std::array<float, 4> lookup(const Scene& scene, const TextureMap& map, const SurfacePlace& place);

/// Multiplies the factors that map MAP_* of a material controls by `texel`; not alpha.
void multiply(shader::SurfaceMaterial& material, uint32_t map, const std::array<float, 4>& texel);

/// Base colour with alpha: factor x texture x vertex colour. Linear, each in [0,1].
std::array<float, 4> base_color_at(const Scene& scene, const SurfacePlace& place);

/// A point's material, with textures and vertex colours multiplied into its factors.
shader::SurfaceMaterial material_at(const Scene& scene, const SurfacePlace& place);

/// Radiance of the front side [W/m2/sr]: factor x texture.
Rgb emission_at(const Scene& scene, const SurfacePlace& place);

/// Probability that the surface is there: 1 opaque; 0 or 1 for masks; alpha for blends.
float coverage_at(const Scene& scene, const SurfacePlace& place);

/// Unit shading normal on the front side: interpolated vertex normals (where `smooth`), perturbed
/// by the normal map. `geometric`: unit normal of the front side. Their cosine is at least 1e-3: a
/// shading normal that points to the back is mirrored at the surface.
Vec3d shading_normal_at(const Scene& scene, const SurfacePlace& place, const Vec3d& geometric);
/// The same for its clear coat, which has a normal map of its own.
Vec3d coat_normal_at(const Scene& scene, const SurfacePlace& place, const Vec3d& geometric);

using LinearTable = std::array<float, 256>;

/// Linear light of an sRGB byte (IEC 61966-2-1).
inline const LinearTable& linear_of_srgb() {
  static const LinearTable table = [] {
    LinearTable t{};
    for (size_t i = 0; i < t.size(); ++i) {
      const double c = static_cast<double>(i) / 255;
      t[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return t;
  }();
  return table;
}

/// byte / 255.
inline const LinearTable& linear_of_byte() {
  static const LinearTable table = [] {
    LinearTable t{};
    for (size_t i = 0; i < t.size(); ++i) t[i] = static_cast<float>(i) / 255.0f;
    return t;
  }();
  return table;
}

}  // namespace tdpt
