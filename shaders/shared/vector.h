// Products of vectors, and orthonormal frames.
#ifndef TDPT_SHADERS_SHARED_VECTOR_H
#define TDPT_SHADERS_SHARED_VECTOR_H

#include "shaders/shared/real.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

GENERIC REAL dot(VEC3 a, VEC3 b) {
  REAL r = a.x * b.x + a.y * b.y + a.z * b.z;
  return r;
}

GENERIC VEC3 cross(VEC3 a, VEC3 b) {
  REAL x = a.y * b.z - a.z * b.y;
  REAL y = a.z * b.x - a.x * b.z;
  REAL z = a.x * b.y - a.y * b.x;
  return VEC3(x, y, z);
}

/// Relative luminance of linear Rec.709.
SHARED float luminance(vec3 c) {
  return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

GENERIC VEC3 normalized(VEC3 v) {
  return v * inverse_root(max(dot(v, v), 1e-37f));
}
GENERIC REAL largest(VEC3 c) {
  return max(max(c.x, c.y), c.z);
}
GENERIC REAL sum_of(VEC3 c) {
  return c.x + c.y + c.z;
}
GENERIC bool is_zero(VEC3 v) {
  return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f;
}
GENERIC bool is_positive(VEC3 c) {
  return c.x > 0.0f || c.y > 0.0f || c.z > 0.0f;
}
GENERIC VEC3 not_below_0(VEC3 c) {
  return VEC3(max(c.x, 0.0f), max(c.y, 0.0f), max(c.z, 0.0f));
}

/// An orthonormal basis.
GENERIC_STRUCT Onb {
  VEC3 x;
  VEC3 y;
  VEC3 z;
};

/// Basis with z along the unit `normal` (Duff et al. 2017).
GENERIC OF_REAL(Onb) onb_about(VEC3 normal) {
  REAL sign = either_sign(normal.z);
  REAL a = -reciprocal(sign + normal.z);
  REAL b = normal.x * normal.y * a;
  REAL xx = REAL(1) + sign * normal.x * normal.x * a;
  REAL xy = sign * b;
  REAL xz = -sign * normal.x;
  REAL yy = sign + normal.y * normal.y * a;
  OF_REAL(Onb) onb;
  onb.x = VEC3(xx, xy, xz);
  onb.y = VEC3(b, yy, -normal.y);
  onb.z = normal;
  return onb;
}

GENERIC VEC3 to_world(OF_REAL(Onb) onb, VEC3 v) {
  VEC3 w = onb.x * v.x + onb.y * v.y + onb.z * v.z;
  return w;
}

GENERIC VEC3 to_local(OF_REAL(Onb) onb, VEC3 w) {
  return VEC3(dot(onb.x, w), dot(onb.y, w), dot(onb.z, w));
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
