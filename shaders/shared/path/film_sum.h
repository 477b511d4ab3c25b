// Adds to the sums of the film by 32-bit atomics: FixedSum of libcommon/film/fixed_sum.h for
// kernels. A unit is 2^-64 times the film's power of two. 128 bits are four words, the lowest
// first, as FixedSum has them in memory. Each overflow of a word carries once into the next, so
// that after all additions the words are the sum, whatever the order; in between they may be too
// small.
//
// Include where film_words[] and atomicAdd() are. Functions change memory that the scope refers to.

#include "shaders/shared/language.h"

/// a rotated left by 1 to 31 bits.
SHARED word64 turned_left(word64 a, uint places) MEMBER_CONST {
  uint high = high_word(a) << places | low_word(a) >> (32u - places);
  uint low = low_word(a) << places | high_word(a) >> (32u - places);
  return word64_of(high, low);
}

/// Whether a random word is below digits 2^-places, places in [1, 85], digits less than 2^24 and
/// 2^places. Digits beyond the word are ignored.
SHARED bool falls_below(word64 coin, uint digits, uint places) MEMBER_CONST {
  if (places <= 32u) return high_word(coin) < digits << (32u - places);
  if (places > 64u) {
    return high_word(coin) == 0u && low_word(coin) < digits >> (places - 64u);
  }
  uint high = places < 64u ? digits >> (places - 32u) : 0u;
  uint low = digits << (64u - places);
  return high_word(coin) < high || (high_word(coin) == high && low_word(coin) < low);
}

/// A value, divided by the film's power of two, in units, rounded up or down at random so that the
/// mean is exact. False if negative, not finite, or at least 2^110 units. `coin`: uniform in
/// 0..2^64-1.
SHARED bool film_units(float value, word64 coin, OUT(uvec4) units) MEMBER_CONST {
  units = uvec4(0u, 0u, 0u, 0u);
  uint bits = floatBitsToUint(value);
  uint exponent = (bits >> 23) & 255u;
  if (exponent == 0u)
    return bits <= 0x80000000u;  // numbers that a device may flush to zero count
                                 // as 0
  // 2^46 has the exponent 173.
  if (bits >> 31 != 0u || exponent >= 173u) return false;
  uint digits = (bits & 0x007FFFFFu) | 0x00800000u;
  // value = digits 2^(exponent - 150), in units digits 2^(exponent - 86).
  if (exponent < 86u) {
    uint places = 86u - exponent;
    uint whole = places < 24u ? digits >> places : 0u;
    uint rest = places < 24u ? digits - (whole << places) : digits;
    units[0] = whole + (falls_below(coin, rest, places) ? 1u : 0u);
    return true;
  }
  uint places = exponent - 86u;
  uint word = places >> 5u;
  uint shift = places & 31u;
  uint low = digits << shift;
  uint high = shift > 8u ? digits >> (32u - shift) : 0u;
  units[0] = word == 0u ? low : 0u;
  units[1] = word == 1u ? low : word == 0u ? high : 0u;
  units[2] = word == 2u ? low : word == 1u ? high : 0u;
  units[3] = word == 2u ? high : 0u;
  return true;
}

/// Adds units to the four words from `first` on. False if the sum overflows.
SHARED bool film_add_units(uint first, uvec4 units) MEMBER_CONST {
  uint carry = 0u;
  for (uint i = 0u; i < 4u; ++i) {
    uint more = units[i] + carry;
    carry = more < carry ? 1u : 0u;
    if (more == 0u) continue;
    uint before = atomicAdd(film_words[first + i], more);
    if (before > ~more) carry = 1u;
  }
  return carry == 0u;
}

/// Adds radiance, divided by the film's power of two, to the twelve words of three sums from
/// `first` on. `coin`: 64 random bits of its own. False if it cannot be held: it is left out, or a
/// sum has overflowed.
SHARED bool film_add(uint first, vec3 radiance, word64 coin) MEMBER_CONST {
  uvec4 red;
  uvec4 green;
  uvec4 blue;
  word64 turned = turned_left(coin, 21u);
  if (!film_units(radiance.x, coin, red)) return false;
  if (!film_units(radiance.y, turned, green)) return false;
  if (!film_units(radiance.z, turned_left(turned, 21u), blue)) return false;
  bool held_red = film_add_units(first, red);
  bool held_green = film_add_units(first + 4u, green);
  bool held_blue = film_add_units(first + 8u, blue);
  return held_red && held_green && held_blue;
}

#include "shaders/shared/language_end.h"
