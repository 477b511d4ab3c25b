// Adds to the sums of the film by 32-bit atomics: FixedSum of libcommon/film/fixed_sum.h for
// kernels. Each overflow of a word carries once into the next, so that after all additions the
// words are the sum, whatever the order; in between they may be too small.
//
// Include where film_words[] and atomicAdd() are. Functions change memory that the scope refers to.

#include "shaders/shared/path/film_units.h"

#include "shaders/shared/language.h"

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
