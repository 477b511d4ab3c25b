// Applies texels to a material: multiplies its factors and bends its normal.
//
// Include in a scope after surface_layout.h and vector.h: a GLSL file, or the body of a C++ struct,
// also in doubles.

#include "shaders/shared/language.h"

struct Texel {
  vec3 rgb;
  float alpha;
};

/// Multiplies a factor of `m` by its map.
SHARED void multiply(INOUT(SurfaceMaterial) m, uint which, Texel t) MEMBER_CONST {
  if (which == MAP_BASE) m.base_color = m.base_color * t.rgb;
  if (which == MAP_METALLIC_ROUGHNESS) {
    m.roughness = m.roughness * t.rgb.y;
    m.metallic = m.metallic * t.rgb.z;
  }
  if (which == MAP_SPECULAR) m.specular = m.specular * t.alpha;
  if (which == MAP_SPECULAR_COLOR) {
    m.specular_color = m.specular_color * t.rgb;
    if ((m.flags & MATERIAL_GLOSSY_MAP) != 0u) m.roughness = 1.0f - (1.0f - m.roughness) * t.alpha;
  }
  if (which == MAP_TRANSMISSION) m.transmission = m.transmission * t.rgb.x;
  if (which == MAP_EMISSION) m.emission = m.emission * t.rgb;
  if (which == MAP_COAT) m.coat = m.coat * t.rgb.x;
  if (which == MAP_COAT_ROUGHNESS) m.coat_roughness = m.coat_roughness * t.rgb.y;
  if (which == MAP_SHEEN_COLOR) m.sheen_color = m.sheen_color * t.rgb;
  if (which == MAP_SHEEN_ROUGHNESS) m.sheen_roughness = m.sheen_roughness * t.alpha;
}

/// `v` divided by its largest component, so that its square is finite; 0 stays 0.
SHARED VEC3 brought_near_1(VEC3 v) MEMBER_CONST {
  REAL most = max(max(abs(v.x), abs(v.y)), abs(v.z));
  bool is_number = most > 1e-30f && most < 1e30f;
  return v * (is_number ? reciprocal(most) : REAL(0.0f));
}

/// `v` without its component along the unit `n`, normalised; 0 if nothing is left.
SHARED VEC3 across(VEC3 v, VEC3 n) MEMBER_CONST {
  VEC3 near_1 = brought_near_1(v);
  VEC3 flat_part = near_1 - n * dot(near_1, n);
  REAL l2 = dot(flat_part, flat_part);
  bool is_left = l2 > 1e-12f * dot(near_1, near_1);
  return flat_part * (is_left ? inverse_root(l2) : REAL(0.0f));
}

/// The unit `n` bent by a normal map. x: unit, perpendicular to n, to the right in the map; hand: 1
/// if the map's up direction lies along cross(n, x), else -1.
SHARED VEC3 bent_by(Texel texel, REAL scale, VEC3 x, REAL hand, VEC3 n) MEMBER_CONST {
  VEC3 t = VEC3(texel.rgb) * REAL(2.0f) - VEC3(1.0f, 1.0f, 1.0f);
  VEC3 bent = x * (t.x * scale) + cross(n, x) * (hand * t.y * scale) + n * t.z;
  REAL l2 = dot(bent, bent);
  return l2 > 1e-18f && l2 < 1e37f ? bent * inverse_root(l2) : n;
}

/// The unit `n`, mirrored at the surface if it points behind it, and never exactly along it.
SHARED VEC3 in_front(VEC3 n, VEC3 geometric) MEMBER_CONST {
  const REAL grazing = REAL(1e-3f);
  REAL cosine = dot(n, geometric);
  if (cosine >= grazing) return n;
  VEC3 flat_part = n - geometric * cosine;
  return normalized(flat_part + geometric * max(-cosine, grazing));
}

#include "shaders/shared/language_end.h"
