// From a place on a face to a point of a path: the text of place_on_surface() of
// tools/tdpt-render/path/sample/surface.cpp in floats.
//
// Read behind maps.h and bsdf.h, within the same scope.

#include "shaders/shared/language.h"

/// `color` and nothing else.
SHARED Bsdf diffuse_bsdf(vec3 color) MEMBER_CONST {
  Bsdf b;
  b.diffuse = color;
  b.f0 = vec3(0.0f);
  b.f90 = vec3(0.0f);
  b.through = vec3(0.0f);
  b.alpha = 1.0f;
  b.eta = 1.0f;
  b.thin = false;
  b.sheen = vec3(0.0f);
  b.sheen_alpha = 0.0f;
  b.coat.strength = 0.0f;
  b.coat.alpha = 0.0f;
  b.coat.normal = vec3(0.0f, 0.0f, 1.0f);
  b.under_coat = vec3(1.0f);
  return b;
}

/// Of material_at().
SHARED Bsdf bsdf_of(SurfaceMaterial m) MEMBER_CONST {
  float dielectric = 1.0f - m.metallic;
  float r = (m.ior - 1.0f) * reciprocal(m.ior + 1.0f);
  vec3 f0 = m.specular_color * (r * r);
  f0 = vec3(min(f0.x, 1.0f), min(f0.y, 1.0f), min(f0.z, 1.0f)) * m.specular;
  Bsdf b = diffuse_bsdf(m.base_color * (dielectric * (1.0f - m.transmission)));
  b.f0 = m.base_color * m.metallic + f0 * dielectric;
  b.f90 = vec3(m.metallic + (m.ior != 1.0f ? m.specular * dielectric : 0.0f));
  if (scene_has_textures && (m.flags & MATERIAL_GLOSSY_MAP) != 0u)
    b.diffuse = b.diffuse * max(1.0f - largest(m.specular_color), 0.0f);
  bool pane = scene_has_panes && m.pane_share > 0.0f;
  if (!pane) b.through = m.base_color * (dielectric * m.transmission);  // past a pane rays go by
  b.alpha = m.roughness * m.roughness;
  b.eta = m.ior;
  b.thin = (m.flags & MATERIAL_SOLID) == 0u;
  if (scene_has_sheen && is_positive(m.sheen_color)) {
    float roughness = max(m.sheen_roughness, 0.07f);
    b.sheen = m.sheen_color;
    b.sheen_alpha = roughness * roughness;
  }
  b.coat.strength = m.coat;
  b.coat.alpha = m.coat_roughness * m.coat_roughness;
  return b;
}

SHARED void add_layers(Face face, SurfaceMaterial m, SurfacePlace at, INOUT(Point) p) MEMBER_CONST {
  p.simple = false;
  bool bent_coat =
      scene_has_coats && m.coat > 0.0f && scene_has_textures && m.maps_of_normals != 0u;
  vec3 coat_normal = face.normal;
  for (uint k = 0u; k < (bent_coat ? 2u : 1u); ++k) {
    vec3 n = shading_normal_at(face,
                               load_material_map(MAPS_OF_MATERIAL * face.material + MAP_NORMAL + k),
                               k == 0u ? m.normal_scale : m.coat_normal_scale, at);
    p.shading = k == 0u ? n : p.shading;
    coat_normal = n;
  }
  if ((m.flags & MATERIAL_PLAIN) != 0u) return;
  p.bsdf = bsdf_of(m);
  p.connectible = bsdf_connectible(p.bsdf);
  if (!has_coat(p.bsdf)) return;
  p.connectible = p.connectible || !coat_smooth(p.bsdf.coat);
  if (bent_coat) p.bsdf.coat.normal = normalized(to_local(onb_about(p.shading), coat_normal));
  if (is_positive(p.bsdf.diffuse)) p.bsdf.under_coat = average_under_coat(p.bsdf);
}

/// Puts `p` on a face, at barycentrics b1, b2 of its second and third corner.
SHARED void place_on_surface(uint triangle, float b1, float b2, OUT(Point) p) MEMBER_CONST {
  SurfacePlace at;
  at.triangle = triangle;
  at.b1 = b1;
  at.b2 = b2;
  Face face = load_face(triangle);
  SurfaceMaterial m = material_at(face.material, at);
  p.position = face.p0 + face.e1 * b1 + face.e2 * b2;
  p.normal = face.normal;
  p.shading = face.normal;
  p.triangle = triangle;
  p.material = face.material;
  p.source = SOURCE_NONE;
  p.simple = true;
  p.connectible = true;
  p.color = m.base_color;
  p.emission = vec3(0.0f);
  p.in_sky.radiance = vec3(0.0f);
  p.in_sky.plain_w = 0.0f;
  p.in_sky.start_w = 0.0f;
  p.bsdf = diffuse_bsdf(m.base_color);
  bool is_plain = (m.flags & MATERIAL_PLAIN) != 0u;
  bool is_flat = !scene_has_normals || face.smoothed == 0u;
  if (scene_has_layers && !(is_plain && is_flat)) add_layers(face, m, at, p);
  if ((m.flags & MATERIAL_EMITS) == 0u) return;
  p.emission = m.emission;
  if (!is_zero(p.emission))
    p.source = (m.flags & MATERIAL_DOUBLE_SIDED) != 0u ? SOURCE_BOTH : SOURCE_FRONT;
}

#include "shaders/shared/language_end.h"
