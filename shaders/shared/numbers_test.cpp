// Random numbers and warps of a device are those of the CPU, bit for bit.
#include <gtest/gtest.h>

#include "libcommon/gpu/kernel.h"
#include "libcommon/math/rng.h"
#include "libcommon/math/sequence.h"
#include "shaders/numbers_test.h"
#include "shaders/shared/numbers_test.h"

namespace tdpt::numbers_test {

constexpr uint32_t kGroups = 64, kInvocations = 64 * kGroups;

std::vector<uint32_t> device_words(const std::vector<shader::uvec4>& sobol_points) {
  gpu::Device device = gpu::Device::open();
  const gpu::Buffer points(device, sobol_points),
      words(device, 4ull * kInvocations * shader::kNumbersOfOne);
  const gpu::Kernel kernel(device, shader::numbers_test_spv, {points, words});
  device.run([&](gpu::Commands& c) { c.dispatch(kernel, {}, kGroups); });
  return words.download<uint32_t>(size_t{kInvocations} * shader::kNumbersOfOne);
}

// Number of words that differ from those of C++.
size_t differences(const std::vector<shader::uvec4>& sobol_points) {
  const std::vector<uint32_t> theirs = device_words(sobol_points);
  size_t n = 0;
  for (uint32_t i = 0; i < kInvocations; ++i) {
    const shader::Numbers mine = shader::draw_numbers(i);
    for (size_t k = 0; k < shader::kNumbersOfOne; ++k)
      n += mine.words[k] != theirs[i * shader::kNumbersOfOne + k];
  }
  return n;
}

const std::vector<shader::uvec4> kPoints(shader::sobol_points.begin(), shader::sobol_points.end());

TEST(numbers, of_a_device_are_those_of_the_cpu) {
  EXPECT_EQ(differences(kPoints), 0u);
}
TEST(numbers, twin_one_wrong_bit_in_the_points_is_seen) {
  std::vector<shader::uvec4> points = kPoints;
  points[77][1] ^= 1;
  EXPECT_GT(differences(points), 0u);
}

// The objects that the renderer uses give the same numbers as the kernels' code.
TEST(numbers, are_those_of_the_objects_that_the_cpu_draws_from) {
  const shader::Numbers drawn = shader::draw_numbers(10);
  const auto at = [&](size_t k) {
    return uint64_t{drawn.words[2 * k]} << 32 | drawn.words[2 * k + 1];
  };
  const uint64_t seed = uint64_t{10 * 0x9E3779B9u} << 32 | ~10u;
  Rng rng(seed, 7, 10, uint64_t{3} << 32 | 2);
  for (size_t k = 0; k < 8; ++k) EXPECT_EQ(at(k), rng.bits());
  Sequence sequence(seed, 2, 0, 10 * 2654435769u);
  sequence.seek(3);
  for (size_t k = 8; k < 18; ++k) EXPECT_EQ(at(k), sequence.bits());
}

}  // namespace tdpt::numbers_test
