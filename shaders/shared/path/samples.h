// Maps samples to pixels and caches, and gives their random numbers.
//
// Include after sequence.h and purposes.h, where `render` and load_cache_offset() are.

#include "shaders/shared/language.h"

// Random dimensions of a walk: those of its start, then those of each bounce, used or not, so that
// a dimension means the same in every sample.
const uint kPerBounce = 8u;
const uint kAimDimension = 4u;

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

#include "shaders/shared/language_end.h"
