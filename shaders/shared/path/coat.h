// Clear coat as in KHR_materials_clearcoat: a colourless dielectric of index 1.5 above the other
// layers, with its own roughness and normal.
//
// Directions are unit and in the coat's frame: z along its normal, on the side of `from`.
// Lobe: strength F D G2 / (4 cos cos), F = 0.04 + 0.96 (1 - c)^5, single scattering [ggx.h].
// The coat transmits 1 - E along each of two directions, E its directional albedo. Layers below are
// scaled by the lesser of the two, except a diffuse lobe [bsdf.h]. The format uses the view
// direction alone, which is not reciprocal.
//
// Include after interface_albedo.h, in the same scope, and after ggx.h.

#include "shaders/shared/language.h"

SHARED bool coat_smooth(IN(Coat) c) MEMBER_CONST {
  return c.alpha < kSmoothAlpha;
}

SHARED REAL coat_fresnel(REAL c) MEMBER_CONST {
  return REAL(0.04) + REAL(0.96) * schlick_curve(c).part;
}

/// 1 - E at cosine `mu`, of either sign.
SHARED REAL coat_left_over(IN(Coat) c, REAL mu) MEMBER_CONST {
  InterfaceAlbedo e = interface_albedo(min(abs(mu), 1.0f), coat_smooth(c) ? 0.0f : REAL(c.alpha));
  return 1.0f - c.strength * (REAL(0.04) * e.a + e.b);
}

/// The half vector and its cosine to both directions; false if there is none.
SHARED bool coat_half_vector(IN(Coat) c, VEC3 from, VEC3 to, OUT(VEC3) h,
                             OUT(REAL) cosine) MEMBER_CONST {
  h = from + to;
  cosine = 0.0f;
  if (coat_smooth(c) || !(from.z > kRoughGrazing) || !(to.z > kRoughGrazing)) return false;
  h = normalized(h);
  cosine = dot(from, h);
  return cosine > 0.0f;
}

/// The lobe, unless it is Dirac; colourless [1/sr].
SHARED REAL coat_f(IN(Coat) c, VEC3 from, VEC3 to) MEMBER_CONST {
  VEC3 h;
  REAL cosine;
  if (!coat_half_vector(c, from, to, h, cosine)) return 0.0f;
  return c.strength * coat_fresnel(min(cosine, 1.0f)) * ggx_d(h, REAL(c.alpha)) *
         ggx_g2_over_cos(from.z, to.z, REAL(c.alpha)) * 0.25f;
}

/// Density of that lobe once the coat is chosen [1/sr].
SHARED REAL coat_pdf_w(IN(Coat) c, VEC3 from, VEC3 to) MEMBER_CONST {
  VEC3 h;
  REAL cosine;
  if (!coat_half_vector(c, from, to, h, cosine)) return 0.0f;
  return ggx_d(h, REAL(c.alpha)) * ggx_g1_over_cos(from.z, REAL(c.alpha)) * 0.25f;
}

/// Reflects `from`, by a Dirac lobe if smooth. False if a facet sends it into the surface.
SHARED bool coat_turn(IN(Coat) c, VEC3 from, REAL u, REAL v, OUT(VEC3) to) MEMBER_CONST {
  to = VEC3(-from.x, -from.y, from.z);
  if (coat_smooth(c)) return from.z > kInSurface;
  if (!(from.z > kRoughGrazing)) return false;
  VEC3 h = ggx_visible_normal(from, REAL(c.alpha), u, v);
  REAL cosine = dot(from, h);
  if (!(h.z > kUprightFacet) || !(cosine > 0.0f)) return false;
  to = normalized(h * (2.0f * cosine) - from);
  return to.z > kRoughGrazing;
}

/// For a smooth coat.
SHARED REAL coat_reflectance(IN(Coat) c, REAL mu) MEMBER_CONST {
  return c.strength * coat_fresnel(min(abs(mu), 1.0f));
}

#include "shaders/shared/language_end.h"
