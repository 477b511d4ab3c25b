// Low-discrepancy random numbers for the samples of a pixel, as an object.
//
// Method: padded Sobol points, Owen-scrambled, with digital shifts; shaders/shared/sequence.h,
// which C++ and kernels share, explains it and lists the symbols. This file makes the table of
// points that it reads, from the direction numbers at compile time, and the class that the renderer
// uses.
#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "libcommon/math/rng.h"

namespace tdpt::sequence {

constexpr uint32_t kBlock = 4;  ///< dimensions of a block

/// One point of a block's Sobol sequence: bit 31 of a coordinate is a half.
using Point = shader::uvec4;

/// What bit k of the index contributes to the point (XOR).
constexpr std::array<Point, 32> directions() {
  // For coordinates 1, 2, 3: degree of the polynomial, its terms between the first and the last,
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

/// sobol_points of shaders/shared/sequence.h.
using Points = std::array<Point, 4 * 256>;
constexpr Points make_points() {
  constexpr std::array<Point, 32> columns = directions();
  Points points{};
  for (uint32_t byte = 0; byte < 4; ++byte)
    for (uint32_t value = 1; value < 256; ++value) {
      // The index without its lowest set bit is an earlier entry.
      const auto bit = static_cast<uint32_t>(std::countr_zero(value));
      points[256 * byte + value] =
          points[256 * byte + (value & (value - 1))] ^ columns[8 * byte + 7 - bit];
    }
  return points;
}

}  // namespace tdpt::sequence

namespace tdpt::shader {
inline constexpr sequence::Points sobol_points = sequence::make_points();
inline const uvec4& load_sobol_point(uint i) {
  return sobol_points[i];
}
}  // namespace tdpt::shader

#include "shaders/shared/sequence.h"

namespace tdpt {

static_assert(sequence::kBlock == shader::kSequenceBlock);

/// See shaders/shared/sequence.h.
class Sequence {
 public:
  Sequence(uint64_t seed, uint64_t stream, uint64_t pixel, uint64_t sample)
      : sequence_(shader::sequence_of(seed, stream, pixel, sample)) {}

  /// The next number is that of dimension d.
  void seek(uint32_t d) { shader::seek(sequence_, d); }
  /// Next dimension, uniform in 0..2^64-1.
  uint64_t bits() { return shader::random_bits(sequence_); }
  /// Next dimension, uniform in [0,1).
  double uniform() { return unit_double(bits()); }
  /// The next N dimensions.
  template <std::size_t N>
  std::array<double, N> uniforms() {
    std::array<double, N> u;
    for (double& x : u) x = uniform();
    return u;
  }

 private:
  shader::Sequence sequence_;
};

}  // namespace tdpt
