// What textures, vertex colours and vertex normals say at one place of a triangle. Only places
// whose material is not `plain` need to ask; the shading normal matters where Scene::smooth says
// so, too. Any texture coordinates will do: what is not a number or beyond 1e9 images counts as 0.
#pragma once
#include <array>

#include "libcommon/scene/scene.h"
#include "shaders/shared/path/surface_layout.h"

namespace tdpt {

/// A place on a triangle: barycentrics of vertices 1 and 2.
struct SurfacePlace {
  uint32_t triangle;
  double b1, b2;
};

/// Texel at a place, linear RGBA in [0,1]; 1 when the map has no image.
std::array<float, 4> lookup(const Scene& scene, const TextureMap& map, const SurfacePlace& place);

/// The factors that map MAP_* of a material multiplies times what it says; not alpha.
void multiply(shader::SurfaceMaterial& material, uint32_t map, const std::array<float, 4>& texel);

/// Base colour with alpha: factor x texture x vertex colour. Linear, each in [0,1].
std::array<float, 4> base_color_at(const Scene& scene, const SurfacePlace& place);

/// A place's material: all that textures and vertex colours say is in its factors.
shader::SurfaceMaterial material_at(const Scene& scene, const SurfacePlace& place);

/// Radiance of the front side [W/m2/sr]: factor x texture.
Rgb emission_at(const Scene& scene, const SurfacePlace& place);

/// Probability that the surface is there: 1 opaque; 0 or 1 for masks; alpha for blends.
float coverage_at(const Scene& scene, const SurfacePlace& place);

/// Unit shading normal on the front side: interpolated vertex normals (where `smooth`), bent by the
/// normal map. `geometric`: unit normal of the front side. Their cosine is at least 1e-3: what
/// points to the back is mirrored at the surface.
Vec3d shading_normal_at(const Scene& scene, const SurfacePlace& place, const Vec3d& geometric);
/// The same of its clear coat, which a normal map of its own bends.
Vec3d coat_normal_at(const Scene& scene, const SurfacePlace& place, const Vec3d& geometric);

}  // namespace tdpt
