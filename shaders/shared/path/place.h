// Turns a place on a face into a point of a path: place_on_surface() of
// tools/tdpt-render/path/sample/surface.cpp in floats; and properties of a point's surface.
//
// Include after maps.h and material.h, in the same scope.

#include "shaders/shared/language.h"

SHARED void add_layers(Face face, SurfaceMaterial m, SurfacePlace at, INOUT(Point) p) MEMBER_CONST {
  p.simple = false;
  bool bent_coat =
      scene_has_coats && m.coat > 0.0f && scene_has_textures && (m.flags & MATERIAL_BENDS) != 0u;
  vec3 coat_normal = face.normal;
  for (uint k = 0u; k < (bent_coat ? 2u : 1u); ++k) {
    vec3 n = shading_normal_at(face,
                               load_material_map(MAPS_OF_MATERIAL * face.material + MAP_NORMAL + k),
                               k == 0u ? m.normal_scale : m.coat_normal_scale, at);
    p.shading = k == 0u ? n : p.shading;
    coat_normal = n;
  }
  if ((m.flags & MATERIAL_PLAIN) == 0u) put_material(m, bent_coat, coat_normal, p);
}

/// Sets `p` to the point of a face at barycentrics b1, b2 of its second and third corner.
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

/// Probability that a pane stops a ray along `w`, of any length; 1 for all other surfaces.
SHARED float opacity_at(uint triangle, vec3 w) MEMBER_CONST {
  if (!scene_has_panes) return 1.0f;
  SurfaceMaterial m = load_material(load_face(triangle).material);
  if (!(m.pane_share > 0.0f)) return 1.0f;
  vec3 unit = normalized(brought_near_1(w));
  OF_FLOAT(FresnelCurve) f = schlick_curve(min(abs(dot(load_face(triangle).normal, unit)), 1.0f));
  return 1.0f - m.pane_share * ((1.0f - m.pane_f90) + (m.pane_f90 - m.pane_f0) * f.rest);
}

SHARED float opacity_of(Point p, vec3 w) MEMBER_CONST {
  return max(opacity_at(p.triangle, w), 1e-6f);
}
SHARED bool is_in_sky(Point p) MEMBER_CONST {
  return p.source == SOURCE_SKY;
}
SHARED vec3 absorption_of(Point p) MEMBER_CONST {
  SurfaceMaterial m = load_material(p.material);
  return (m.flags & MATERIAL_ABSORBS) != 0u ? m.absorption : vec3(0.0f);
}

#include "shaders/shared/language_end.h"
