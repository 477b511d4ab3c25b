// The random numbers of shaders/shared/rng.h as an object. Doubles are drawn on the CPU only.
#pragma once
#include <cstdint>

#include "libcommon/math/vec.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/warp.h"

namespace tdpt {

using shader::mix64;

/// In [0,1): multiples of 2^-53.
constexpr double unit_double(uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

class Rng {
 public:
  Rng(uint64_t seed, uint64_t stream, uint64_t a, uint64_t b = 0)
      : rng_(shader::rng_of(seed, stream, a, b)) {}

  /// Next dimension, uniform in 0..2^64-1.
  uint64_t bits() { return shader::random_bits(rng_); }
  /// Next dimension, uniform in [0,1).
  double uniform() { return unit_double(bits()); }
  float uniform_float() { return shader::unit_float(shader::high_word(bits())); }
  /// Uniform in 0..n-1, n > 0.
  uint32_t below(uint32_t n) {
    return static_cast<uint32_t>((static_cast<unsigned __int128>(bits()) * n) >> 64);
  }

 private:
  shader::Rng rng_;
};

// The warps of shaders/shared/warp.h, in floats and in doubles.

using shader::cosine_hemisphere;
using shader::uniform_triangle;

}  // namespace tdpt
