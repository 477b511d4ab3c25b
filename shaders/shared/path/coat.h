// Clear coat in floats [tools/tdpt-render/path/bsdf/coat.h], in the coat's frame: z along its
// normal, on the side of `from`.
//
// Read behind interface_albedo.h, within the same scope; ggx.h comes before.

#include "shaders/shared/language.h"

SHARED bool coat_smooth(Coat c) MEMBER_CONST {
  return c.alpha < kSmoothAlpha;
}

SHARED float coat_fresnel(float c) MEMBER_CONST {
  return 0.04f + 0.96f * schlick_curve(c).part;
}

/// 1 - E at cosine `mu`, of either sign.
SHARED float coat_left_over(Coat c, float mu) MEMBER_CONST {
  InterfaceAlbedo e = interface_albedo(min(abs(mu), 1.0f), coat_smooth(c) ? 0.0f : c.alpha);
  return 1.0f - c.strength * (0.04f * e.a + e.b);
}

/// The half vector and its cosine to both; false: there is none.
SHARED bool coat_half_vector(Coat c, vec3 from, vec3 to, OUT(vec3) h,
                             OUT(float) cosine) MEMBER_CONST {
  h = from + to;
  cosine = 0.0f;
  if (coat_smooth(c) || !(from.z > kRoughGrazing) || !(to.z > kRoughGrazing)) return false;
  h = normalized(h);
  cosine = dot(from, h);
  return cosine > 0.0f;
}

/// The lobe that is not Dirac, colourless [1/sr].
SHARED float coat_f(Coat c, vec3 from, vec3 to) MEMBER_CONST {
  vec3 h;
  float cosine;
  if (!coat_half_vector(c, from, to, h, cosine)) return 0.0f;
  return c.strength * coat_fresnel(min(cosine, 1.0f)) * ggx_d(h, c.alpha) *
         ggx_g2_over_cos(from.z, to.z, c.alpha) * 0.25f;
}

/// Its density once the coat is taken [1/sr].
SHARED float coat_pdf_w(Coat c, vec3 from, vec3 to) MEMBER_CONST {
  vec3 h;
  float cosine;
  if (!coat_half_vector(c, from, to, h, cosine)) return 0.0f;
  return ggx_d(h, c.alpha) * ggx_g1_over_cos(from.z, c.alpha) * 0.25f;
}

/// Reflects `from`, by a Dirac lobe if smooth. False when facets send it into the surface.
SHARED bool coat_turn(Coat c, vec3 from, float u, float v, OUT(vec3) to) MEMBER_CONST {
  to = vec3(-from.x, -from.y, from.z);
  if (coat_smooth(c)) return from.z > kInSurface;
  if (!(from.z > kRoughGrazing)) return false;
  vec3 h = ggx_visible_normal(from, c.alpha, u, v);
  float cosine = dot(from, h);
  if (!(h.z > kUprightFacet) || !(cosine > 0.0f)) return false;
  to = normalized(h * (2.0f * cosine) - from);
  return to.z > kRoughGrazing;
}

/// Of a smooth coat.
SHARED float coat_reflectance(Coat c, float mu) MEMBER_CONST {
  return c.strength * coat_fresnel(min(abs(mu), 1.0f));
}

#include "shaders/shared/language_end.h"
