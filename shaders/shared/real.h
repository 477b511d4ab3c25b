// Arithmetic that gives the same bits on every device, from sums, products, comparisons and bits of
// floats only. Vulkan allows an error of 2.5 units in the last place for quotients, more for roots,
// and 2^-11 for sines; these functions keep the bounds given here. For doubles, which only C++
// uses, the library's own functions are provided under the same names.
#ifndef TDPT_SHADERS_SHARED_REAL_H
#define TDPT_SHADERS_SHARED_REAL_H

#include "shaders/shared/language.h"

SHARED_BEGIN

/// 1/x, to 2 units in the last place. 1e-37 <= |x| <= 1e37.
SHARED float reciprocal(float x) {
  float a = abs(x);
  // Newton's iteration from a guess with 12 % error; each step squares the error.
  float y = uintBitsToFloat(0x7EF311C7u - floatBitsToUint(a));
  y = y * (2.0f - a * y);
  y = y * (2.0f - a * y);
  y = y * (2.0f - a * y);
  y = y * (2.0f - a * y);
  return x < 0.0f ? -y : y;
}

/// 1/sqrt(x), to 3 units in the last place. 1e-37 <= x <= 1e37.
SHARED float inverse_root(float x) {
  float h = 0.5f * x;
  float y = uintBitsToFloat(0x5F3759DFu - (floatBitsToUint(x) >> 1));
  y = y * (1.5f - h * y * y);
  y = y * (1.5f - h * y * y);
  y = y * (1.5f - h * y * y);
  y = y * (1.5f - h * y * y);
  return y;
}

/// sqrt(x) to 3 units in the last place; 0 below 1e-37.
SHARED float root(float x) {
  float r = x < 1e-37f ? 0.0f : x * inverse_root(x);
  return r;
}

/// 1 or -1 by the sign of x; for a zero it may be either.
SHARED float either_sign(float x) {
  return x < 0.0f ? -1.0f : 1.0f;
}

/// Cosine and sine of `turns` full turns, in [0,1); to 2e-7.
SHARED void cos_sin_turns(float turns, OUT(float) cosine, OUT(float) sine) {
  // Reduced to an eighth of a turn on either side of a quarter; Taylor series from there.
  float quarters = 4.0f * turns;
  float nearest = floor(quarters + 0.5f);
  float x = (quarters - nearest) * 1.57079633f;
  float x2 = x * x;
  float s =
      x * (1.0f + x2 * (-1.66666667e-1f +
                        x2 * (8.33333333e-3f + x2 * (-1.98412698e-4f + x2 * 2.75573192e-6f))));
  float c =
      1.0f + x2 * (-0.5f + x2 * (4.16666667e-2f + x2 * (-1.38888889e-3f + x2 * 2.48015873e-5f)));
  int quadrant = int(nearest);  // 0 to 4
  bool odd = (quadrant & 1) != 0;
  float a = odd ? s : c;
  float b = odd ? c : s;
  cosine = quadrant == 1 || quadrant == 2 ? -a : a;
  sine = quadrant == 2 || quadrant == 3 ? -b : b;
}

#ifdef __cplusplus

inline double reciprocal(double x) {
  return 1 / x;
}
inline double root(double x) {
  return std::sqrt(std::max(x, 0.0));
}
inline double inverse_root(double x) {
  return 1 / std::sqrt(x);
}
inline double either_sign(double x) {
  return std::copysign(1.0, x);
}
inline void cos_sin_turns(double turns, double& cosine, double& sine) {
  const double angle = 2 * std::numbers::pi * turns;
  cosine = std::cos(angle);
  sine = std::sin(angle);
}

#endif

SHARED_END

#include "shaders/shared/language_end.h"

#endif
