// Reflectance and transmittance of an interface: the interpolation from f0 to f90, by Schlick's
// curve or by the exact one of unpolarised light, and its complement, each without cancellation
// where it is small.
//
// Letters: c cosine in front of the interface, `ratio` index behind it / in front of it, `rise`
// ratio - 1 (passed separately, since near 1 it is all that matters), q = ratio * cosine behind it:
// q^2 = rise (ratio + 1) + c^2.
#ifndef TDPT_SHADERS_SHARED_PATH_FRESNEL_H
#define TDPT_SHADERS_SHARED_PATH_FRESNEL_H

#include "shaders/shared/real.h"

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
  OF_REAL(FresnelCurve) f;
  f.part = m2 * m2 * m;
  f.rest = c * (1.0f + m + m2 + m2 * m + m2 * m2);
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
  OF_REAL(FresnelCurve) f;
  f.part = min(max((0.5f * (rs * rs + rp * rp) - r * r) * over_rest, 0.0f), 1.0f);
  f.rest = min(2.0f * c * q * (a2 + b2) * over_rest, 1.0f);
  return f;
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
