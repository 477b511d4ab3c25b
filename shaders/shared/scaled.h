// Numbers with a float's digits and an unlimited exponent: products of densities along a path can
// leave the range of a float and return to it by a later factor.
#ifndef TDPT_SHADERS_SHARED_SCALED_H
#define TDPT_SHADERS_SHARED_SCALED_H

#include "shaders/shared/elementary.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// digits 2^exponent; digits are 0 or of magnitude in [1/2, 1).
struct Scaled {
  float digits;
  int exponent;
};

/// digits 2^exponent, for any digits; NaN and infinity are kept; values that a device may flush to
/// zero (below 2^-126) become 0.
SHARED Scaled scaled(float digits, int exponent) {
  uint bits = floatBitsToUint(digits);
  int e = int((bits >> 23) & 255u);
  Scaled s;
  s.digits = e == 0 ? 0.0f : digits;
  s.exponent = exponent;
  if (e == 0 || e == 255) return s;
  s.digits = uintBitsToFloat((bits & 0x807FFFFFu) | 0x3F000000u);
  s.exponent = exponent + e - 126;
  return s;
}
SHARED Scaled scaled(float value) {
  return scaled(value, 0);
}

SHARED Scaled product(Scaled a, Scaled b) {
  return scaled(a.digits * b.digits, a.exponent + b.exponent);
}
SHARED Scaled product(Scaled a, float b) {
  return product(a, scaled(b));
}
/// b not 0.
SHARED Scaled quotient(Scaled a, Scaled b) {
  return scaled(a.digits * reciprocal(b.digits), a.exponent - b.exponent);
}

SHARED Scaled sum(Scaled a, Scaled b) {
  if (a.digits == 0.0f) return b;
  if (b.digits == 0.0f) return a;
  int most = max(a.exponent, b.exponent);
  float of_a = most - a.exponent > 64 ? 0.0f : a.digits * power_of_two(a.exponent - most);
  float of_b = most - b.exponent > 64 ? 0.0f : b.digits * power_of_two(b.exponent - most);
  return scaled(of_a + of_b, most);
}

/// As a float: 0 below 2^-126, 3e38 above 2^126.
SHARED float narrowed(Scaled a) {
  if (a.digits == 0.0f || a.exponent < -125) return 0.0f * a.digits;
  if (a.exponent > 126) return a.digits < 0.0f ? -3e38f : 3e38f;
  return a.digits * power_of_two(a.exponent);
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
