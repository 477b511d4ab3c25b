// Maps uniform random numbers in [0,1) to distributions; their densities are given.
#ifndef TDPT_SHADERS_SHARED_WARP_H
#define TDPT_SHADERS_SHARED_WARP_H

#include "shaders/shared/vector.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// Direction about +z with pdf_w = cos/pi [1/sr].
GENERIC VEC3 cosine_hemisphere(REAL u, REAL v) {
  REAL cosine = REAL(0);
  REAL sine = REAL(0);
  cos_sin_turns(u, cosine, sine);
  REAL r = root(v);
  REAL x = r * cosine;
  REAL y = r * sine;
  REAL z = root(REAL(1) - v);
  return VEC3(x, y, z);
}

/// Direction on the side of the unit `normal` with pdf_w = cos/pi [1/sr].
GENERIC VEC3 cosine_hemisphere(VEC3 normal, REAL u, REAL v) {
  return to_world(onb_about(normal), cosine_hemisphere(u, v));
}

/// Barycentrics (b1, b2) of vertices 1 and 2, uniform by area: pdf_A = 1/area [1/m2].
GENERIC void uniform_triangle(REAL u, REAL v, OUT(REAL) b1, OUT(REAL) b2) {
  REAL r = root(u);
  REAL first = r * (REAL(1) - v);
  REAL second = r * v;
  b1 = first;
  b2 = second;
}

/// Importance-samples a density linear on [0,1] from w0 to w1: the place where its CDF is `share`.
GENERIC REAL drawn_linear(REAL w0, REAL w1, REAL share) {
  REAL most = max(w0, w1);
  if (!(most > 1e-30f)) return share;
  REAL per_most = reciprocal(most);
  REAL a = w0 * per_most;
  REAL b = w1 * per_most;
  REAL grown = a + root(a * a + share * (b * b - a * a));
  return grown > 0.0f ? min(REAL(1), share * (a + b) * reciprocal(grown)) : share;
}
GENERIC REAL between_corners(REAL upper_left, REAL upper_right, REAL lower_left, REAL lower_right,
                             REAL across, REAL down) {
  REAL upper = upper_left * (1.0f - across) + upper_right * across;
  REAL lower = lower_left * (1.0f - across) + lower_right * across;
  return upper * (1.0f - down) + lower * down;
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
