// Writes the results of samples: the film's sums and the counts beside them [path/sample/tally.h of
// the renderer], all by integer atomics, so that order cannot matter.
//
// Include after film_sum.h, where `render` and tally_bucket() are: counts are spread over several
// buckets.

#include "shaders/shared/language.h"

SHARED void count_ray(uint kind) MEMBER_CONST {
  atomicAdd(film_words[render.tally_first + tally_bucket() * kTallyWords + kind],
            render.ray_counts_as);
}

SHARED void count_rays(uint kind, uint n) MEMBER_CONST {
  atomicAdd(film_words[render.tally_first + tally_bucket() * kTallyWords + kind], n);
}

/// Luminance for reports: rounded down.
SHARED void add_energy(uint first, float value) MEMBER_CONST {
  uvec4 units;
  if (film_units(value, word64_of(0xFFFFFFFFu, 0xFFFFFFFFu), units)) film_add_units(first, units);
}

/// Index of the sum by length for paths of k edges: more than 2^(i-1), up to 2^i.
SHARED uint octave_of(uint k) MEMBER_CONST {
  uint octave = 0u;
  for (uint rest = k - 1u; rest != 0u; rest >>= 1) octave += 1u;
  return octave;
}

/// Counts a contribution that is left out and records its place if it is one of the first few: each
/// word passes on what is not the first.
SHARED void leave_out(uint pixel, word64 number) MEMBER_CONST {
  uint first = render.tally_first + kTallyBuckets * kTallyWords;
  atomicAdd(film_words[first], 1u);
  uint pixels = render.width * render.height;
  uint later = low_word(number) - render.first_number;
  if (later >= 0xFFFFFFFFu / pixels) return;  // its place does not fit in a word
  uint place = 0xFFFFFFFFu - (later * pixels + pixel);
  for (uint i = 1u; i <= kLeftOutPlaces; ++i)
    place = min(place, atomicMax(film_words[first + i], place));
}

/// Adds a technique's contribution by a path of k edges to a pixel and returns its luminance;
/// `number`: of the sample. A value that the film cannot hold is counted and left out.
SHARED float add_found(uint technique, uint pixel, uint k, word64 number, vec3 value,
                       float weight) MEMBER_CONST {
  vec3 found = value * weight;
  if (is_zero(found)) return 0.0f;
  word64 a = word64_of(floatBitsToUint(found.x), floatBitsToUint(found.y));
  word64 b = word64_of(pixel, floatBitsToUint(found.z) + technique);
  word64 coin = mix64(sum64(mix64(sum64(mix64(a), b)), number));
  if (!film_add(12u * pixel, found, coin)) {
    leave_out(pixel, number);
    return 0.0f;
  }
  if (film_has_layers)
    film_add(12u * (render.width * render.height * (1u + technique) + pixel), found, mix64(coin));
  if (film_has_halves && (low_word(number) & 1u) != 0u)
    film_add(render.odd_first + 12u * pixel, found, coin);
  float brought = luminance(found);
  uint energies = render.tally_first + tally_bucket() * kTallyWords + TALLY_ENERGIES;
  add_energy(energies + 4u * technique, brought);
  add_energy(energies + 4u * (5u + octave_of(k)), brought);
  return brought;
}

/// The camera ray of a sample of the pixel has hit something.
SHARED void meet_pixel(uint pixel) MEMBER_CONST {
  atomicAdd(film_words[render.met_first + pixel], 1u);
}

SHARED void count_drawn(uint portal) MEMBER_CONST {
  atomicAdd(film_words[render.portals_first + portal * kPortalWords], 1u);
}
/// A segment has contributed light.
SHARED void count_lit(uint portal, bool first_time, float brought) MEMBER_CONST {
  uint first = render.portals_first + portal * kPortalWords;
  if (first_time) atomicAdd(film_words[first + 1u], 1u);
  add_energy(first + 2u, brought);
}

#include "shaders/shared/language_end.h"
