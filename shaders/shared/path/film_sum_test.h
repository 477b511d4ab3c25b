// Test only: what invocation i adds to the film. Include after film_sum.h.

#include "shaders/shared/language.h"

/// Random digits, and exponents from far below a unit to more than the film can hold.
SHARED float film_trial_value(INOUT(Rng) rng) MEMBER_CONST {
  uint word = random_word(rng);
  uint exponent = 20u + below(random_word(rng), 155u);
  if ((word & 0x3Fu) == 0u) return 0.0f;
  return uintBitsToFloat(exponent << 23 | word >> 9);
}

SHARED vec3 film_trial_radiance(INOUT(Rng) rng) MEMBER_CONST {
  float x = film_trial_value(rng);
  float y = film_trial_value(rng);
  float z = film_trial_value(rng);
  return vec3(x, y, z);
}

/// Adds to one of five pixels. False if it cannot be held.
SHARED bool film_trial(uint i) MEMBER_CONST {
  Rng rng = rng_of(word64_of(0u, 5u), word64_of(0u, 0u), word64_of(0u, i), word64_of(0u, 0u));
  vec3 radiance = film_trial_radiance(rng);
  return film_add(12u * (i % 5u), radiance, random_bits(rng));
}

#include "shaders/shared/language_end.h"
