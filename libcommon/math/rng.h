// Random numbers as a function of (seed, stream, pixel, sample, dimension): no state is shared, so
// results do not depend on threads, order, or on how a run is split.
#pragma once
#include <cstdint>

namespace tdpt {

/// Bijective mixing of 64 bits (the finaliser of SplitMix64).
constexpr uint64_t mix64(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

class Rng {
 public:
  /// `stream` keeps users of one seed apart (an integrator, a stage of a tool); `a` and `b` name
  /// the sample (pixel and sample index, walk number, ...).
  constexpr Rng(uint64_t seed, uint64_t stream, uint64_t a, uint64_t b = 0)
      : key_(mix64(mix64(mix64(mix64(seed + kGolden) + stream + kGolden) + a + kGolden) + b)) {}

  /// Next dimension, uniform in 0..2^64-1.
  constexpr uint64_t bits() { return mix64(key_ += kGolden); }
  /// Next dimension, uniform in [0,1).
  constexpr double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  constexpr float uniform_float() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }
  /// Uniform in 0..n-1, n > 0.
  constexpr uint32_t below(uint32_t n) {
    return static_cast<uint32_t>((static_cast<unsigned __int128>(bits()) * n) >> 64);
  }

 private:
  static constexpr uint64_t kGolden = 0x9e3779b97f4a7c15ull;
  uint64_t key_;
};

}  // namespace tdpt
