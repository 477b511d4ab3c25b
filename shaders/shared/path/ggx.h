// GGX microfacets (Walter et al. 2007) with height-correlated Smith masking (Heitz 2014). Shading
// frame, z along the normal; directions are unit with w.z > 0; a = alpha > 0. Expressions avoid
// cancellation near the normal and the horizon.
//   D(h) = a^2 / (pi ((h.z a)^2 + h.x^2 + h.y^2)^2)
//   L(w) = (sqrt(1 + a^2 tan^2) - 1) / 2, G1 = 1/(1 + L), G2(v, w) = 1/(1 + L(v) + L(w))
//   D_w(h) = D(h) G1(w) (w.h) / w.z, the density of normals visible from w [1/sr]
#ifndef TDPT_SHADERS_SHARED_PATH_GGX_H
#define TDPT_SHADERS_SHARED_PATH_GGX_H

#include "shaders/shared/vector.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

const float kSmoothAlpha =
    1.00000005e-4f;  ///< smaller alpha counts as 0; 1e-4f itself does not, as in doubles
const float kMatchedIndices = 1e-4f;  ///< alpha also counts as 0 if the indices differ by less
const float kInSurface = 1e-20f;      ///< directions with a smaller cosine lie in the surface
const float kRoughGrazing = 1e-9f;    ///< a rough interface is not evaluated at smaller cosines
const float kUprightFacet = 1e-6f;    ///< steeper facets are dropped: rounding would lose their
                                      ///< density
const float kNarrowAlpha = 0.3f;  ///< lobes of smaller alpha are narrow: guiding does not replace
                                  ///< them

/// D [1/sr].
GENERIC REAL ggx_d(VEC3 h, REAL a) {
  REAL s = a * a * (h.z * h.z) + (h.x * h.x + h.y * h.y);
  REAL t = a * reciprocal(s);
  return t * t * INVERSE_PI;
}

/// (1 + 2 L(w)) w_z.
GENERIC REAL ggx_stretched(REAL cosine, REAL a) {
  return root(a * a + (1.0f - a) * (1.0f + a) * (cosine * cosine));
}

/// G1(w) / w_z; finite down to w_z = 0.
GENERIC REAL ggx_g1_over_cos(REAL cosine, REAL a) {
  return 2.0f * reciprocal(cosine + ggx_stretched(cosine, a));
}

/// G2(v, w) / (v_z w_z).
GENERIC REAL ggx_g2_over_cos(REAL cos_v, REAL cos_w, REAL a) {
  return 2.0f * reciprocal(cos_w * ggx_stretched(cos_v, a) + cos_v * ggx_stretched(cos_w, a));
}

/// Samples a normal with density D_w(h) from two uniform numbers in [0,1) (Dupuy and Benyoub 2023,
/// spherical caps); 0 in a case of probability 0.
GENERIC VEC3 ggx_visible_normal(VEC3 w, REAL a, REAL u, REAL v) {
  VEC3 s = VEC3(a * w.x, a * w.y, w.z);
  s = s * inverse_root(max(dot(s, s), 1e-37f));
  REAL cosine = REAL(0);
  REAL sine = REAL(0);
  cos_sin_turns(u, cosine, sine);
  REAL below = v * (1.0f + s.z);  // 1 - z, z the height in the cap
  REAL hz = (1.0f - v) * (1.0f + s.z);
  REAL r = root(max(below * (2.0f - below), 0.0f));
  VEC3 h = VEC3(a * (r * cosine + s.x), a * (r * sine + s.y), hz);
  REAL l2 = dot(h, h);
  return l2 > 1e-36f ? h * inverse_root(l2) : VEC3(0.0f);
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
