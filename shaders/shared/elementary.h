// Elementary functions that give the same bits on every device (see real.h), from sums and products
// alone. Coefficients: minimax polynomials of Moshier's Cephes library.
#ifndef TDPT_SHADERS_SHARED_ELEMENTARY_H
#define TDPT_SHADERS_SHARED_ELEMENTARY_H

#include "shaders/shared/real.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// 2^n, n in [-126, 127].
SHARED float power_of_two(int n) {
  return uintBitsToFloat(uint(n + 127) << 23);
}

/// e^x, relative error 2e-7; 0 below -87, 3e38 above 88.
SHARED float exponential(float x) {
  if (!(x > -87.0f)) return 0.0f;
  if (x > 88.0f) return 3e38f;
  float n = floor(x * 1.44269504f + 0.5f);
  float r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
  float p = 1.9875691500e-4f;
  p = p * r + 1.3981999507e-3f;
  p = p * r + 8.3334519073e-3f;
  p = p * r + 4.1665795894e-2f;
  p = p * r + 1.6666665459e-1f;
  p = p * r + 5.0000001201e-1f;
  return ((p * r * r + r) + 1.0f) * power_of_two(int(n));
}

/// Natural logarithm, relative error 2e-7 (near 1: of x - 1); x >= 1e-37.
SHARED float logarithm(float x) {
  uint bits = floatBitsToUint(x);
  int exponent = int(bits >> 23) - 126;
  float m = uintBitsToFloat((bits & 0x007FFFFFu) | 0x3F000000u);  // [1/2, 1)
  if (m < 0.707106781f) {
    m = m + m;
    exponent -= 1;
  }
  m = m - 1.0f;
  float z = m * m;
  float p = 7.0376836292e-2f;
  p = p * m - 1.1514610310e-1f;
  p = p * m + 1.1676998740e-1f;
  p = p * m - 1.2420140846e-1f;
  p = p * m + 1.4249322787e-1f;
  p = p * m - 1.6668057665e-1f;
  p = p * m + 2.0000714765e-1f;
  p = p * m - 2.4999993993e-1f;
  p = p * m + 3.3333331174e-1f;
  float e = float(exponent);
  float y = m * z * p - e * 2.12194440e-4f - 0.5f * z;
  return (m + y) + e * 0.693359375f;
}

/// x^y, relative error |y log x| 1e-7 + 3e-7; 0 where x < 1e-37, except for y = 0.
SHARED float power(float x, float y) {
  if (y == 0.0f) return 1.0f;
  return x < 1e-37f ? 0.0f : exponential(y * logarithm(x));
}

/// Angle of (x, y) from the x axis in full turns, counter-clockwise, [-1/2, 1/2]; error 3e-8. 0 for
/// (0, 0).
SHARED float turns_of(float y, float x) {
  float a = abs(x);
  float b = abs(y);
  float most = max(a, b);
  if (most < 1e-37f) return 0.0f;
  float t = min(a, b) * reciprocal(most);
  // At most an eighth of a turn, reduced to a sixteenth on either side of 0.
  bool steep = t > 0.41421356f;
  float s = steep ? (t - 1.0f) * reciprocal(t + 1.0f) : t;
  float z = s * s;
  float p = 8.05374449538e-2f;
  p = p * z - 1.38776856032e-1f;
  p = p * z + 1.99777106478e-1f;
  p = p * z - 3.33329491539e-1f;
  float turns = (p * z * s + s) * 0.159154943f;
  if (steep) turns = turns + 1.25e-1f;
  if (b > a) turns = 0.25f - turns;
  if (x < 0.0f) turns = 0.5f - turns;
  return y < 0.0f ? -turns : turns;
}

#ifdef __cplusplus

inline double exponential(double x) {
  return std::exp(x);
}
inline double power(double x, double y) {
  return std::pow(x, y);
}
inline double turns_of(double y, double x) {
  return std::atan2(y, x) * (0.5 * std::numbers::inv_pi);
}

#endif

SHARED_END

#include "shaders/shared/language_end.h"

#endif
