// What an interface reflects and what it lets pass: the way from f0 to f90, by Schlick's curve or
// by the exact one of unpolarised light, and its rest, each without cancelling where it is small.
//
// Letters: c cosine before the interface, `ratio` index behind it / before it, `rise` ratio - 1
// (given, as near 1 the difference is all that matters), q = ratio * cosine behind it:
// q^2 = rise (ratio + 1) + c^2.
#ifndef TDPT_SHADERS_SHARED_PATH_FRESNEL_H
#define TDPT_SHADERS_SHARED_PATH_FRESNEL_H

#include "shaders/shared/real.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

struct FresnelCurve {
  float part;  ///< of the way from f0 to f90
  float rest;  ///< 1 - part
};

/// (1 - c)^5 and 1 - (1 - c)^5.
SHARED FresnelCurve schlick_curve(float c) {
  float m = 1.0f - c;
  float m2 = m * m;
  FresnelCurve f;
  f.part = m2 * m2 * m;
  f.rest = c * (1.0f + m + m2 + m2 * m + m2 * m2);
  return f;
}

/// q; -1: total reflection.
SHARED float refracted_q(float c, float ratio, float rise) {
  float q2 = rise * (ratio + 1.0f) + c * c;
  return q2 > 0.0f ? root(q2) : -1.0f;
}

/// Of unpolarised light, with q from refracted_q(), not -1: (F - r0) / (1 - r0), r0 = F at c = 1.
SHARED FresnelCurve exact_curve(float cosine, float q, float ratio, float rise) {
  float c = max(cosine, 1e-9f);
  float k = rise * (ratio + 1.0f);
  float over_ratio = reciprocal(ratio);
  float over_a = reciprocal(c + q);
  float over_b = reciprocal(ratio * c + q * over_ratio);
  float a2 = over_a * over_a;
  float b2 = over_b * over_b;
  float rs = k * a2;
  float rp = k * ((ratio * ratio + 1.0f) * (c * c) - 1.0f) * (b2 * (over_ratio * over_ratio));
  float r = rise * reciprocal(ratio + 1.0f);
  float over_rest = 0.25f * (ratio + 1.0f) * (ratio + 1.0f) * over_ratio;  // 1 / (1 - r0)
  FresnelCurve f;
  f.part = min(max((0.5f * (rs * rs + rp * rp) - r * r) * over_rest, 0.0f), 1.0f);
  f.rest = min(2.0f * c * q * (a2 + b2) * over_rest, 1.0f);
  return f;
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
