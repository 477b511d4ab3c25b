// Reflectance and transmittance of an interface: the interpolation from f0 to f90, by Schlick's
// curve or by the exact one of unpolarised light, and its complement, each without cancellation
// where it is small.
//
// Letters: c cosine in front of the interface, `ratio` index behind it / in front of it, `rise`
// ratio - 1 (passed separately, since near 1 it is all that matters), q = ratio * cosine behind it:
// q^2 = rise (ratio + 1) + c^2.
#ifndef TDPT_SHADERS_SHARED_PATH_MICROFACET_H
#define TDPT_SHADERS_SHARED_PATH_MICROFACET_H

#include "shaders/shared/real.h"
#include "shaders/shared/vector.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

GENERIC_STRUCT FresnelCurve {
  REAL part;  ///< share of the way from f0 to f90
  REAL rest;  ///< 1 - part
};

/// Reflectance for unpolarised light of a conductor of index eta + i k, at cosine c.
GENERIC REAL conductor_reflectance(REAL c, REAL eta, REAL k) {
  REAL c2 = c * c;
  REAL s2 = 1.0f - c2;
  REAL t = eta * eta - k * k - s2;
  REAL q2 = root(t * t + 4.0f * eta * eta * k * k);  // |q|^2
  REAL re = root(max(0.5f * (q2 + t), 0.0f));
  REAL rs = (q2 + c2 - 2.0f * c * re) * reciprocal(q2 + c2 + 2.0f * c * re);
  REAL a = c2 * q2 + s2 * s2;
  REAL rp = (a - 2.0f * c * re * s2) * reciprocal(a + 2.0f * c * re * s2);
  return 0.5f * rs * (1.0f + rp);
}

/// Difference between Schlick's curve and that of a conductor, as a coefficient of c (1 - c)^6,
/// exact at c = 1/7, about 82 degrees, where that term is largest (Hoffman 2019, "Fresnel equations
/// considered harmful"). For metals the remaining error is up to 0.05, on average over a hemisphere
/// below 0.005; Schlick's alone is up to 0.26 off.
GENERIC REAL conductor_dip(REAL eta, REAL k) {
  REAL c = REAL(1.0 / 7.0);
  REAL m = 1.0f - c;
  REAL m3 = m * m * m;
  REAL f0 = conductor_reflectance(REAL(1.0f), eta, k);
  REAL schlick = f0 + (1.0f - f0) * m3 * m * m;
  return max(schlick - conductor_reflectance(c, eta, k), 0.0f) * reciprocal(c * m3 * m3);
}

/// (1 - c)^5 and 1 - (1 - c)^5.
GENERIC OF_REAL(FresnelCurve) schlick_curve(REAL c) {
  REAL m = 1.0f - c;
  REAL m2 = m * m;
  OF_REAL(FresnelCurve) f = {m2 * m2 * m, c * (1.0f + m + m2 + m2 * m + m2 * m2)};
  return f;
}

/// q; -1: total reflection.
GENERIC REAL refracted_q(REAL c, REAL ratio, REAL rise) {
  REAL q2 = rise * (ratio + 1.0f) + c * c;
  return q2 > 0.0f ? root(q2) : -1.0f;
}

/// Exact, for unpolarised light; q from refracted_q(), not -1: (F - r0) / (1 - r0), r0 = F at c =
/// 1.
GENERIC OF_REAL(FresnelCurve) exact_curve(REAL cosine, REAL q, REAL ratio, REAL rise) {
  REAL c = max(cosine, 1e-9f);
  REAL k = rise * (ratio + 1.0f);
  REAL over_ratio = reciprocal(ratio);
  REAL over_a = reciprocal(c + q);
  REAL over_b = reciprocal(ratio * c + q * over_ratio);
  REAL a2 = over_a * over_a;
  REAL b2 = over_b * over_b;
  REAL rs = k * a2;
  REAL rp = k * ((ratio * ratio + 1.0f) * (c * c) - 1.0f) * (b2 * (over_ratio * over_ratio));
  REAL r = rise * reciprocal(ratio + 1.0f);
  REAL over_rest = 0.25f * (ratio + 1.0f) * (ratio + 1.0f) * over_ratio;  // 1 / (1 - r0)
  OF_REAL(FresnelCurve)
  f = {min(max((0.5f * (rs * rs + rp * rp) - r * r) * over_rest, 0.0f), 1.0f),
       min(2.0f * c * q * (a2 + b2) * over_rest, 1.0f)};
  return f;
}

// GGX microfacets (Walter et al. 2007) with height-correlated Smith masking (Heitz 2014). Shading
// frame, z along the normal; directions are unit with w.z > 0; a = alpha > 0. Expressions avoid
// cancellation near the normal and the horizon.
//   D(h) = a^2 / (pi ((h.z a)^2 + h.x^2 + h.y^2)^2)
//   L(w) = (sqrt(1 + a^2 tan^2) - 1) / 2, G1 = 1/(1 + L), G2(v, w) = 1/(1 + L(v) + L(w))
//   D_w(h) = D(h) G1(w) (w.h) / w.z, the density of normals visible from w [1/sr]

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
