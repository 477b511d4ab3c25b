// Random numbers as a function of (seed, stream, a, b, dimension): SplitMix64 (Steele, Lea and
// Flood 2014) started from a key that mixes the first four. There is no shared state, so results do
// not depend on threads, order, device, or how a run is split.
#ifndef TDPT_SHADERS_SHARED_RNG_H
#define TDPT_SHADERS_SHARED_RNG_H

#include "shaders/shared/language.h"

SHARED_BEGIN

/// Bijective mixing of 64 bits (the finaliser of SplitMix64).
SHARED word64 mix64(word64 a) {
  word64 z = product64(a ^ down64(a, 30u), word64_of(0xbf58476du, 0x1ce4e5b9u));
  z = product64(z ^ down64(z, 27u), word64_of(0x94d049bbu, 0x133111ebu));
  return z ^ down64(z, 31u);
}

/// 2^64 over the golden ratio: the step of SplitMix64.
SHARED word64 golden64() {
  return word64_of(0x9e3779b9u, 0x7f4a7c15u);
}

/// The numbers of one sample.
struct Rng {
  word64 key;
};

/// `stream` separates users of one seed (an integrator, a stage of a tool); `a` and `b` identify
/// the sample (pixel and sample index, walk number, ...).
SHARED Rng rng_of(word64 seed, word64 stream, word64 a, word64 b) {
  Rng rng;
  rng.key = mix64(sum64(seed, golden64()));
  rng.key = mix64(sum64(sum64(rng.key, stream), golden64()));
  rng.key = mix64(sum64(sum64(rng.key, a), golden64()));
  rng.key = mix64(sum64(rng.key, b));
  return rng;
}

/// Next dimension, uniform in 0..2^64-1.
SHARED word64 random_bits(INOUT(Rng) rng) {
  rng.key = sum64(rng.key, golden64());
  return mix64(rng.key);
}

/// Next dimension, uniform in 0..2^32-1.
SHARED uint random_word(INOUT(Rng) rng) {
  return high_word(random_bits(rng));
}

/// In [0,1): multiples of 2^-24.
SHARED float unit_float(uint word) {
  float u = float(word >> 8) * 5.9604644775390625e-8f;
  return u;
}

/// Uniform in 0..n-1 from one word, n > 0.
SHARED uint below(uint word, uint n) {
  uint high;
  uint low;
  umulExtended(word, n, high, low);
  return high;
}

/// In [0,1): a fixed pseudo-random number for two words.
SHARED float hashed_unit(uint a, uint b) {
  return unit_float(high_word(mix64(word64_of(a, b))));
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
