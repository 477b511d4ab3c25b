// Converts a material to a BSDF.
//
// Include after bsdf.h, in the same scope, which also has scene_has_textures and scene_has_panes,
// and after surface_layout.h.

#include "shaders/shared/language.h"

/// Only diffuse, of colour `color`.
SHARED Bsdf diffuse_bsdf(vec3 color) MEMBER_CONST {
  Bsdf b;
  b.diffuse = color;
  b.f0 = vec3(0.0f);
  b.f90 = 0.0f;
  b.through = vec3(0.0f);
  b.alpha = 1.0f;
  b.dip = vec3(0.0f);
  b.eta = 1.0f;
  b.thin = 0u;
  b.sheen = vec3(0.0f);
  b.sheen_alpha = 0.0f;
  b.coat.strength = 0.0f;
  b.coat.alpha = 0.0f;
  b.coat.normal = vec3(0.0f, 0.0f, 1.0f);
  b.coat.under = vec3(1.0f);
  return b;
}

/// The BSDF of a material after textures: glTF 2.0 appendix B with KHR_materials_specular, _ior and
/// _transmission. Dielectric and metal share one microfacet lobe, since Schlick's F is linear in f0
/// and f90.
SHARED Bsdf bsdf_of(IN(SurfaceMaterial) m) MEMBER_CONST {
  float dielectric = 1.0f - m.metallic;
  float r = (m.ior - 1.0f) * reciprocal(m.ior + 1.0f);
  vec3 f0 = m.specular_color * (r * r);
  f0 = vec3(min(f0.x, 1.0f), min(f0.y, 1.0f), min(f0.z, 1.0f)) * m.specular;
  Bsdf b = diffuse_bsdf(m.base_color * (dielectric * (1.0f - m.transmission)));
  b.f0 = m.base_color * m.metallic + f0 * dielectric;
  b.dip = m.dip * m.metallic;
  b.f90 = m.metallic + (m.ior != 1.0f ? m.specular * dielectric : 0.0f);
  if (scene_has_textures && (m.flags & MATERIAL_GLOSSY_MAP) != 0u)
    b.diffuse = b.diffuse * max(1.0f - largest(m.specular_color), 0.0f);
  bool pane = scene_has_panes && m.pane_share > 0.0f;
  if (!pane) b.through = m.base_color * (dielectric * m.transmission);  // rays pass through panes
  b.alpha = m.roughness * m.roughness;
  b.eta = m.ior;
  b.thin = (m.flags & MATERIAL_SOLID) == 0u ? 1u : 0u;
  if (scene_has_sheen && is_positive(m.sheen_color)) {
    float roughness = max(m.sheen_roughness, kLeastSheenRoughness);
    b.sheen = m.sheen_color;
    b.sheen_alpha = roughness * roughness;
  }
  b.coat.strength = m.coat;
  b.coat.alpha = m.coat_roughness * m.coat_roughness;
  return b;
}

/// Sets the material of a point that has more than a diffuse lobe; its shading normal is known.
/// coat_normal: unit, on the front; used only if bent_coat.
SHARED void put_material(IN(SurfaceMaterial) m, bool bent_coat, VEC3 coat_normal,
                         INOUT(Point) p) MEMBER_CONST {
  p.bsdf = bsdf_of(m);
  p.connectible = bsdf_connectible(p.bsdf);
  if (!has_coat(p.bsdf)) return;
  p.connectible = p.connectible || !coat_smooth(p.bsdf.coat);
  if (bent_coat) p.bsdf.coat.normal = vec3(normalized(to_local(onb_about(p.shading), coat_normal)));
  if (is_positive(p.bsdf.diffuse)) p.bsdf.coat.under = vec3(average_under_coat(p.bsdf));
}

#include "shaders/shared/language_end.h"
