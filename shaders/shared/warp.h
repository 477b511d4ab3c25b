// Warps from uniform random numbers to distributions, as libcommon/math/warp.h has them for the
// CPU, without roots where there is a way without.
#ifndef TDPT_SHADERS_SHARED_WARP_H
#define TDPT_SHADERS_SHARED_WARP_H

#include "shaders/shared/real.h"

SHARED_BEGIN

/// A point of the triangle, uniform by area: the half of the square beyond its diagonal is turned
/// over.
SHARED vec3 uniform_triangle(vec3 a, vec3 b, vec3 c, float u, float v) {
  EXACT float sum = u + v;
  bool beyond = sum > 1.0f;
  EXACT float s = beyond ? 1.0f - u : u;
  EXACT float t = beyond ? 1.0f - v : v;
  EXACT vec3 p = a + (b - a) * s + (c - a) * t;
  return p;
}

/// Direction on the side of the unit `normal` with pdf_w = cos/pi [1/sr]; the frame about the
/// normal is that of Duff et al. 2017.
SHARED vec3 cosine_hemisphere(vec3 normal, float u, float v) {
  float cosine;
  float sine;
  cos_sin_turns(u, cosine, sine);
  EXACT float r = root(v);
  EXACT float x = r * cosine;
  EXACT float y = r * sine;
  EXACT float z = root(1.0f - v);
  float sign = normal.z < 0.0f ? -1.0f : 1.0f;
  EXACT float a = -reciprocal(sign + normal.z);
  EXACT float b = normal.x * normal.y * a;
  EXACT vec3 s = vec3(1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
  EXACT vec3 t = vec3(b, sign + normal.y * normal.y * a, -normal.y);
  EXACT vec3 w = s * x + t * y + normal * z;
  return w;
}

SHARED_END

#endif
