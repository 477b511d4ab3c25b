// Which samples there are, which pools they are of, and their random numbers.
//
// Read behind sequence.h and purposes.h, where `render` and load_pool_offset() are.

#include "shaders/shared/language.h"

// Dimensions of a walk: of its start, then of each bounce, used or not, so that one means the same
// in every sample.
const uint kPerBounce = 8u;
const uint kAimDimension = 4u;

struct SampleName {
  uint pixel;
  word64 number;
};

/// Pixel i of a pool. Each is of a stretch of its own, as long as there are pools.
SHARED uint pixel_of_pool(uint pool, uint i) MEMBER_CONST {
  uint stretch = i * render.pools;
  if (stretch + render.pools > render.width * render.height) return stretch + pool;
  return stretch + (pool + load_pool_offset(i)) % render.pools;
}
SHARED uint pool_of_group(uint group) MEMBER_CONST {
  return (render.first_pool + group) % render.pools;
}
SHARED uint samples_of_pool(uint pool) MEMBER_CONST {
  return (render.width * render.height - pool + render.pools - 1u) / render.pools;
}
SHARED uint walks_of_pool(uint pool) MEMBER_CONST {
  return samples_of_pool(pool) == render.per_pool ? render.walks_full : render.walks_less;
}
SHARED SampleName sample_of_group(uint group, uint i) MEMBER_CONST {
  SampleName s;
  s.pixel = pixel_of_pool(pool_of_group(group), i);
  s.number = sum64(render.first_sample, word64_of(0u, (render.first_pool + group) / render.pools));
  return s;
}

SHARED Sequence numbers_of(SampleName s, uint purpose) MEMBER_CONST {
  word64 pixel = word64_of(s.pixel / render.width, s.pixel % render.width);
  return sequence_of(render.seed, sum64(render.stream, word64_of(0u, purpose)), pixel, s.number);
}
SHARED float uniform_of(INOUT(Sequence) numbers) MEMBER_CONST {
  return unit_float(high_word(random_bits(numbers)));
}

#include "shaders/shared/language_end.h"
