// Random numbers of a pixel that fill the unit cube more evenly than independent ones: padded Sobol
// points in hashed order with digital shifts, a function of (seed, stream, pixel, sample,
// dimension) alone as those of rng.h are.
//
// Dimensions come in blocks of four. Within a block, sample i is point s(i) of the Sobol sequence
// (direction numbers of the primitive polynomials x + 1, x^2 + x + 1, x^3 + x + 1 with the initial
// values of Joe and Kuo), where s permutes the samples within every aligned run of 2^k; each
// dimension is then shifted on its own (exclusive or with a random number). The permutation is a
// nested uniform scrambling (Owen) of the index: a bit is flipped or not by a coin that the bits
// above it choose, and a hash is the coin. Blocks have independent hashes, so that dimensions of
// two blocks are paired at random and each number by itself is uniform over the seeds: estimates
// stay unbiased.
//   B. Burley, Practical Hash-based Owen Scrambling, JCGT 9(4), 2020;
//   the hash is of the kind of S. Laine and T. Karras, with the constants of N. Vegdahl.
#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "libcommon/math/rng.h"

namespace tdpt {
namespace sequence {

constexpr uint32_t kBlock = 4;  ///< dimensions of a block

constexpr uint32_t reverse_bits(uint32_t x) {
  x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
  x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
  x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
  return __builtin_bswap32(x);
}

/// Nested uniform scrambling of a number whose bits are reversed: each step lets a bit depend on
/// itself and on lower bits only.
constexpr uint32_t scramble_reversed(uint32_t x, uint32_t key) {
  x ^= x * 0x3d20adeau;
  x += key;
  x *= key >> 16 | 1;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// One point of a block's Sobol sequence: bit 31 of a coordinate is a half.
using Point = std::array<uint32_t, kBlock>;

/// What bit k of the index adds to the point.
constexpr std::array<Point, 32> directions() {
  // Of coordinates 1, 2, 3: the polynomial's degree and its terms between the first and the last,
  // and as many odd numbers m_k. Direction number v_k = m_k / 2^(k+1).
  struct Polynomial {
    uint32_t degree, middle;
    std::array<uint32_t, 3> m;
  };
  constexpr std::array<Polynomial, kBlock - 1> polynomials{
      {{1, 0, {1, 0, 0}}, {2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}}};
  std::array<Point, 32> columns{};
  for (uint32_t k = 0; k < 32; ++k) columns[k][0] = 1u << (31 - k);
  for (uint32_t d = 1; d < kBlock; ++d) {
    const Polynomial& p = polynomials[d - 1];
    std::array<uint32_t, 32> v{};
    for (uint32_t k = 0; k < 32; ++k) {
      if (k < p.degree) {
        v[k] = p.m[k] << (31 - k);
      } else {
        v[k] = v[k - p.degree] ^ v[k - p.degree] >> p.degree;
        for (uint32_t j = 1; j < p.degree; ++j)
          if (p.middle >> (p.degree - 1 - j) & 1) v[k] ^= v[k - j];
      }
      columns[k][d] = v[k];
    }
  }
  return columns;
}

/// What each byte of an index whose bits are reversed adds to the point; byte 0 is the highest.
using Table = std::array<std::array<Point, 256>, 4>;
constexpr Table make_table() {
  constexpr std::array<Point, 32> columns = directions();
  Table table{};
  for (uint32_t byte = 0; byte < 4; ++byte)
    for (uint32_t value = 1; value < 256; ++value) {
      // All but the lowest set bit is an earlier entry.
      const auto bit = static_cast<uint32_t>(std::countr_zero(value));
      const Point& rest = table[byte][value & (value - 1)];
      const Point& column = columns[8 * byte + 7 - bit];
      for (uint32_t d = 0; d < kBlock; ++d) table[byte][value][d] = rest[d] ^ column[d];
    }
  return table;
}
inline constexpr Table kTable = make_table();

}  // namespace sequence

/// The numbers of one sample. Takes the place of Rng where a pixel takes many samples. Of any
/// aligned run of 2^k samples, each interval of length 2^-k of every dimension gets one, and so
/// does each rectangle of area 2^-k (sides powers of two) of the first two dimensions of a block.
class Sequence {
 public:
  /// Stream and pixel as in Rng; samples are numbered 0, 1, 2, ... Runs of 2^32 samples are
  /// independent of each other.
  constexpr Sequence(uint64_t seed, uint64_t stream, uint64_t pixel, uint64_t sample)
      : key_(Rng(seed, stream, pixel, sample >> 32).bits()),
        sample_(sequence::reverse_bits(static_cast<uint32_t>(sample))) {}

  /// The next number is that of dimension d. What a dimension stands for must not depend on the
  /// sample, or samples do not complement each other.
  constexpr void seek(uint32_t d) {
    dimension_ = d;
    if (d % sequence::kBlock != 0) begin_block();
  }

  /// Next dimension, uniform in 0..2^64-1. The upper 32 bits are those of the sequence; the lower
  /// ones are hashed.
  constexpr uint64_t bits() {
    using namespace sequence;
    const uint32_t d = dimension_ % kBlock;
    if (d == 0) begin_block();
    ++dimension_;
    const uint64_t key = mix64(block_key_ + d);
    const uint64_t low = (key ^ sample_) * kGolden;
    return uint64_t{point_[d] ^ static_cast<uint32_t>(key)} << 32 | low >> 32;
  }
  /// Next dimension, uniform in [0,1).
  constexpr double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// The next N dimensions.
  template <std::size_t N>
  constexpr std::array<double, N> uniforms() {
    std::array<double, N> u;
    for (double& x : u) x = uniform();
    return u;
  }

 private:
  static constexpr uint64_t kGolden = 0x9e3779b97f4a7c15ull;

  constexpr void begin_block() {
    using namespace sequence;
    block_key_ = mix64(key_ + (dimension_ / kBlock + 1) * kGolden);
    const auto order = static_cast<uint32_t>(block_key_ >> 32);
    // The same flips are taken off every index: what is above a sample's highest bit stays 0.
    uint32_t index = scramble_reversed(sample_, order) ^ scramble_reversed(0, order);
    point_ = kTable[0][index >> 24];
    for (uint32_t byte = 1; (index <<= 8) != 0; ++byte) {
      const sequence::Point& part = kTable[byte][index >> 24];
      for (uint32_t d = 0; d < kBlock; ++d) point_[d] ^= part[d];
    }
  }

  uint64_t key_, block_key_ = 0;
  uint32_t sample_;  // bits reversed
  uint32_t dimension_ = 0;
  sequence::Point point_{};
};

}  // namespace tdpt
