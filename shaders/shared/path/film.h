// The film: writes the results of samples, maps samples to pixels and caches, gives their random
// numbers, and maps pixels to directions and back.
//
// Results are the film's sums and the counts beside them [path/sample/tally.h of the renderer], all
// by integer atomics, so that order cannot matter.
//
// Include after film_sum.h, where `render`, load_cache_offset() and tally_bucket() are: counts are
// spread over several buckets.

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

// The pinhole camera: maps pixels to directions and back, and gives its importance:
// libcommon/scene/film_plane.h in floats.

/// Unit direction through the raster position (x, y).
SHARED vec3 camera_direction(float x, float y) MEMBER_CONST {
  float u = (2.0f * x * reciprocal(float(render.width)) - 1.0f) * render.half_width;
  float v = (1.0f - 2.0f * y * reciprocal(float(render.height))) * render.half_height;
  return normalized(render.camera_forward + render.camera_right * u + render.camera_up * v);
}

/// Raster position for unit `w` (away from the camera); false if it misses the film.
SHARED bool camera_raster(vec3 w, OUT(float) x, OUT(float) y) MEMBER_CONST {
  x = 0.0f;
  y = 0.0f;
  float c = dot(w, render.camera_forward);
  if (!(c > 1e-30f)) return false;
  float across = dot(w, render.camera_right) * reciprocal(c * render.half_width);
  float down = dot(w, render.camera_up) * reciprocal(c * render.half_height);
  float width = float(render.width);
  float height = float(render.height);
  x = 0.5f * width * (1.0f + across);
  y = 0.5f * height * (1.0f - down);
  return x >= 0.0f && x < width && y >= 0.0f && y < height;
}

/// Density of w if the raster position is uniform over the whole film [1/sr].
SHARED float camera_pdf_w(vec3 w) MEMBER_CONST {
  float c = max(dot(w, render.camera_forward), 1e-9f);
  return reciprocal(render.film_area * c * c * c);
}

// Random dimensions of a walk: those of its start, then those of each bounce, used or not, so that
// a dimension means the same in every sample.
const uint kPerBounce = 8u;

struct SampleName {
  uint pixel;
  word64 number;
};

/// Pixel i of a cache. The picture is divided into stretches of one pixel per cache.
SHARED uint pixel_of_cache(uint cache, uint i) MEMBER_CONST {
  uint stretch = i * render.caches;
  if (stretch + render.caches > render.width * render.height) return stretch + cache;
  return stretch + (cache + load_cache_offset(i)) % render.caches;
}
SHARED uint cache_of_group(uint group) MEMBER_CONST {
  return (render.first_cache + group) % render.caches;
}
SHARED uint samples_of_cache(uint cache) MEMBER_CONST {
  return (render.width * render.height - cache + render.caches - 1u) / render.caches;
}
SHARED uint walks_of_cache(uint cache) MEMBER_CONST {
  return samples_of_cache(cache) == render.per_cache ? render.walks_full : render.walks_less;
}
SHARED SampleName sample_of_group(uint group, uint i) MEMBER_CONST {
  SampleName s;
  s.pixel = pixel_of_cache(cache_of_group(group), i);
  s.number =
      sum64(render.first_sample, word64_of(0u, (render.first_cache + group) / render.caches));
  return s;
}

SHARED Sequence numbers_of(SampleName s, uint purpose) MEMBER_CONST {
  word64 pixel = word64_of(s.pixel / render.width, s.pixel % render.width);
  return sequence_of(render.seed, sum64(render.stream, word64_of(0u, purpose)), pixel,
                     number_in_half(s.number));
}
SHARED float uniform_of(INOUT(Sequence) numbers) MEMBER_CONST {
  return unit_float(high_word(random_bits(numbers)));
}

struct FourNumbers {
  float a;
  float b;
  float c;
  float d;
};
/// The next four numbers, each in [0,1).
SHARED FourNumbers four_numbers_of(INOUT(Sequence) numbers) MEMBER_CONST {
  FourNumbers n;
  n.a = uniform_of(numbers);
  n.b = uniform_of(numbers);
  n.c = uniform_of(numbers);
  n.d = uniform_of(numbers);
  return n;
}

#include "shaders/shared/language_end.h"
