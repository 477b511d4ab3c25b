// Test only: random numbers, warps and elementary functions as words, to compare a device with C++.
#ifndef TDPT_SHADERS_SHARED_NUMBERS_TEST_H
#define TDPT_SHADERS_SHARED_NUMBERS_TEST_H

#include "shaders/shared/scaled.h"
#include "shaders/shared/sequence.h"
#include "shaders/shared/warp.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

const uint kNumbersOfOne = 72u;

struct Numbers {
  uint words[72];
};

/// The numbers of invocation i.
SHARED Numbers draw_numbers(uint i) {
  Numbers drawn;
  uint n = 0u;
  word64 seed = word64_of(i * 0x9E3779B9u, ~i);
  Rng rng = rng_of(seed, word64_of(i & 1u, 7u), word64_of(0u, i), word64_of(3u, i / 5u));
  for (uint k = 0u; k < 8u; ++k) {
    word64 bits = random_bits(rng);
    drawn.words[n] = high_word(bits);
    drawn.words[n + 1u] = low_word(bits);
    n += 2u;
  }
  Sequence sequence = sequence_of(seed, word64_of(0u, 2u), word64_of(0u, i / 64u),
                                  word64_of(i & 1u, i * 2654435769u));
  seek(sequence, i % 7u);
  for (uint k = 0u; k < 10u; ++k) {
    word64 bits = random_bits(sequence);
    drawn.words[n] = high_word(bits);
    drawn.words[n + 1u] = low_word(bits);
    n += 2u;
  }
  float u = unit_float(drawn.words[0]);
  float v = unit_float(drawn.words[1]);
  vec3 up = cosine_hemisphere(u, v);
  vec3 w = cosine_hemisphere(up, v, unit_float(drawn.words[2]));
  float b1;
  float b2;
  uniform_triangle(u, v, b1, b2);
  vec3 across = cross(up, w);
  drawn.words[n] = floatBitsToUint(up.x);
  drawn.words[n + 1u] = floatBitsToUint(up.y);
  drawn.words[n + 2u] = floatBitsToUint(up.z);
  drawn.words[n + 3u] = floatBitsToUint(w.x);
  drawn.words[n + 4u] = floatBitsToUint(w.y);
  drawn.words[n + 5u] = floatBitsToUint(w.z);
  drawn.words[n + 6u] = floatBitsToUint(b1);
  drawn.words[n + 7u] = floatBitsToUint(b2);
  drawn.words[n + 8u] = floatBitsToUint(across.x);
  drawn.words[n + 9u] = floatBitsToUint(across.y);
  drawn.words[n + 10u] = floatBitsToUint(across.z);
  drawn.words[n + 11u] = floatBitsToUint(dot(up, w));
  n += 12u;
  drawn.words[n] = floatBitsToUint(exponential(180.0f * u - 90.0f));
  drawn.words[n + 1u] = floatBitsToUint(logarithm(max(u, 1e-37f)));
  drawn.words[n + 2u] = floatBitsToUint(power(u, 10.0f * v));
  drawn.words[n + 3u] = floatBitsToUint(turns_of(2.0f * u - 1.0f, 2.0f * v - 1.0f));
  Scaled p = sum(product(scaled(u), v), quotient(scaled(v), scaled(u + 1e-9f)));
  drawn.words[n + 4u] = floatBitsToUint(narrowed(p));
  drawn.words[n + 5u] = uint(p.exponent);
  n += 6u;
  while (n < kNumbersOfOne) {
    drawn.words[n] = below(drawn.words[n - 16u], n);
    n += 1u;
  }
  return drawn;
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
