// Random numbers as a function of (seed, stream, sample, round, dimension): Philox4x32-10 (Salmon,
// Moraes, Dror, Shaw 2011). No state is shared, so results do not depend on order or on the device.
#ifndef TDPT_SHADERS_SHARED_RANDOM_H
#define TDPT_SHADERS_SHARED_RANDOM_H

#include "shaders/shared/rng.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// Ten rounds of the bijection that `key` picks among four words.
SHARED uvec4 philox(uvec4 counter, uvec2 key) {
  uvec4 c = counter;
  uint k0 = key.x;
  uint k1 = key.y;
  for (int i = 0; i < 10; ++i) {
    uint high0;
    uint low0;
    uint high1;
    uint low1;
    umulExtended(0xD2511F53u, c[0], high0, low0);
    umulExtended(0xCD9E8D57u, c[2], high1, low1);
    c = uvec4(high1 ^ c[1] ^ k0, low1, high0 ^ c[3] ^ k1, low0);
    k0 += 0x9E3779B9u;
    k1 += 0xBB67AE85u;
  }
  return c;
}

/// The numbers of one sample.
struct RandomNumbers {
  uvec2 seed;
  uint stream;  ///< keeps users of one seed apart
  uint sample_index;
  uint round;
  uint drawn;   ///< dimensions so far
  uvec4 words;  ///< of the block that is being handed out
};

SHARED RandomNumbers random_numbers(uvec2 seed, uint stream, uint sample_index, uint round) {
  RandomNumbers r;
  r.seed = seed;
  r.stream = stream;
  r.sample_index = sample_index;
  r.round = round;
  r.drawn = 0u;
  r.words = uvec4(0u, 0u, 0u, 0u);
  return r;
}

/// Next dimension, uniform in 0..2^32-1.
SHARED uint random_word(INOUT(RandomNumbers) r) {
  uint i = r.drawn & 3u;
  if (i == 0u) r.words = philox(uvec4(r.drawn >> 2, r.sample_index, r.round, r.stream), r.seed);
  r.drawn += 1u;
  return r.words[i];
}

/// Mixes two words into one (xor-shift and multiply; bijective in each).
SHARED uint mixed(uint a, uint b) {
  uint h = a ^ (b * 0x9E3779B1u);
  h = (h ^ (h >> 16)) * 0x7FEB352Du;
  h = (h ^ (h >> 15)) * 0x846CA68Bu;
  return h ^ (h >> 16);
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
