// Low-discrepancy random numbers for a pixel: padded Sobol points in hashed order with digital
// shifts. Like those of rng.h they are a function of (seed, stream, pixel, sample, dimension)
// alone.
//
// Dimensions come in blocks of four. Within a block, sample i is point s(i) of the Sobol sequence
// (direction numbers of the primitive polynomials x + 1, x^2 + x + 1, x^3 + x + 1 with the initial
// values of Joe and Kuo), where s permutes the samples within every aligned run of 2^k. Each
// dimension is then digitally shifted on its own (exclusive or with a random number). The
// permutation is nested uniform (Owen) scrambling of the index: a hash of the bits above a bit
// decides whether it is flipped. Blocks have independent hashes, so that dimensions of two blocks
// are paired at random and each number by itself is uniform over the seeds: estimates stay
// unbiased.
//   B. Burley, Practical Hash-based Owen Scrambling, JCGT 9(4), 2020;
//   the hash is of the kind of S. Laine and T. Karras, with the constants of N. Vegdahl.
//
// The caller provides load_sobol_point(), which reads the points of libcommon/math/sequence.h.
#ifndef TDPT_SHADERS_SHARED_SEQUENCE_H
#define TDPT_SHADERS_SHARED_SEQUENCE_H

#include "shaders/shared/rng.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// [256 * k + value]: contribution of byte k of a bit-reversed index to the point; byte 0 is the
/// highest.
#ifdef __cplusplus
inline const uvec4& load_sobol_point(uint i);
#else
uvec4 load_sobol_point(uint i);
#endif

const uint kSequenceBlock = 4u;  // dimensions of a block

/// The numbers of one sample; used instead of Rng where a pixel takes many samples. Of any aligned
/// run of 2^k samples, each interval of length 2^-k of every dimension gets one, and so does each
/// rectangle of area 2^-k (sides powers of two) of the first two dimensions of a block.
struct Sequence {
  word64 key;
  word64 block_key;
  uint reversed;  ///< bit-reversed sample number
  uint dimension;
  uvec4 point;  ///< of the block; bit 31 of a coordinate stands for 1/2
};

/// The number that sequence_of() takes for a sample, less than 2^63, of a pixel: of each run of
/// 2^32 samples, 0, 2, 4, ... and 1, 3, 5, ... are two halves, each a run of its own. So each half
/// is stratified, and the two are independent.
SHARED word64 number_in_half(word64 number) {
  return word64_of(high_word(number) << 1 | (low_word(number) & 1u), low_word(number) >> 1);
}

/// Stream and pixel correspond to stream and a of Rng; samples are numbered 0, 1, 2, ... Runs of
/// 2^32 samples are independent of each other.
SHARED Sequence sequence_of(word64 seed, word64 stream, word64 pixel, word64 number) {
  Rng rng = rng_of(seed, stream, pixel, word64_of(0u, high_word(number)));
  Sequence s;
  s.key = random_bits(rng);
  s.block_key = word64_of(0u, 0u);
  s.reversed = bitfieldReverse(low_word(number));
  s.dimension = 0u;
  s.point = uvec4(0u, 0u, 0u, 0u);
  return s;
}

/// Nested uniform scrambling of a bit-reversed number: in each step a bit depends only on itself
/// and on lower bits.
SHARED uint scramble_reversed(uint number, uint key) {
  uint x = number ^ number * 0x3d20adeau;
  x += key;
  x *= key >> 16 | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

SHARED void begin_block(INOUT(Sequence) s) {
  word64 number = word64_of(0u, s.dimension / kSequenceBlock + 1u);
  s.block_key = mix64(sum64(s.key, product64(number, golden64())));
  uint order = high_word(s.block_key);
  // Undo the flips of index 0 for every index: bits above a sample's highest bit stay 0.
  uint index = scramble_reversed(s.reversed, order) ^ scramble_reversed(0u, order);
  s.point = load_sobol_point(index >> 24);
  index <<= 8;
  for (uint k = 1u; index != 0u; ++k) {
    s.point = s.point ^ load_sobol_point(256u * k + (index >> 24));
    index <<= 8;
  }
}

/// The next number is that of dimension d. The use of a dimension must not depend on the sample, or
/// the samples do not stratify it.
SHARED void seek(INOUT(Sequence) s, uint d) {
  s.dimension = d;
  if (d % kSequenceBlock != 0u) begin_block(s);
}

/// Next dimension, uniform in 0..2^64-1. The upper word comes from the sequence; the lower one is
/// hashed.
SHARED word64 random_bits(INOUT(Sequence) s) {
  uint d = s.dimension % kSequenceBlock;
  if (d == 0u) begin_block(s);
  s.dimension += 1u;
  word64 key = mix64(sum64(s.block_key, word64_of(0u, d)));
  word64 low = product64(key ^ word64_of(0u, s.reversed), golden64());
  return word64_of(s.point[d] ^ low_word(key), high_word(low));
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
