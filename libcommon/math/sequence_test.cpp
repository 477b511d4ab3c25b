#include "libcommon/math/sequence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "libcommon/testing/statistics/chi_square.h"

namespace tdpt::sequence_test {

double number(uint64_t seed, uint64_t stream, uint64_t pixel, uint64_t sample, uint32_t d) {
  Sequence sequence(seed, stream, pixel, sample);
  sequence.seek(d);
  return sequence.uniform();
}

double independent(uint64_t seed, uint64_t stream, uint64_t pixel, uint64_t sample, uint32_t d) {
  Rng rng(seed, stream, pixel, sample);
  double u = 0;
  for (uint32_t i = 0; i <= d; ++i) u = rng.uniform();
  return u;
}

using Numbers = double (*)(uint64_t, uint64_t, uint64_t, uint64_t, uint32_t);

// Whether each cell of 2^-a by 2^-(k-a) in dimensions d and e contains one of 2^k samples from
// `first` on.
bool one_in_each_cell(Numbers numbers, uint64_t pixel, uint64_t first, int k, int a, uint32_t d,
                      uint32_t e) {
  std::set<std::pair<int, int>> cells;
  for (uint64_t i = 0; i < uint64_t{1} << k; ++i)
    cells.insert({static_cast<int>(std::ldexp(numbers(1, 2, pixel, first + i, d), a)),
                  static_cast<int>(std::ldexp(numbers(1, 2, pixel, first + i, e), k - a))});
  return cells.size() == size_t{1} << k;
}

bool every_interval_has_its_sample(Numbers numbers, uint64_t shift) {
  for (int k = 0; k <= 8; ++k)
    for (uint64_t run : {0, 1, 2, 7, 100})
      for (uint32_t d = 0; d < 3 * sequence::kBlock; ++d)
        if (!one_in_each_cell(numbers, run + 5, (run << k) + shift, k, k, d, d)) return false;
  return true;
}
TEST(sequence, aligned_runs_put_one_sample_into_each_interval_of_every_dimension) {
  constexpr uint64_t kOther = uint64_t{1} << 32;  // above it are new runs
  EXPECT_TRUE(every_interval_has_its_sample(number, 0));
  EXPECT_TRUE(every_interval_has_its_sample(number, kOther));
  // Twins: independent numbers, and runs that are not aligned.
  EXPECT_FALSE(every_interval_has_its_sample(independent, 0));
  EXPECT_FALSE(every_interval_has_its_sample(number, 1));
  EXPECT_FALSE(every_interval_has_its_sample(number, kOther - 1));
}

template <uint64_t half>
double number_of_half(uint64_t seed, uint64_t stream, uint64_t pixel, uint64_t sample, uint32_t d) {
  return number(seed, stream, pixel, shader::number_in_half(2 * sample + half), d);
}
double number_of_both(uint64_t seed, uint64_t stream, uint64_t pixel, uint64_t sample, uint32_t d) {
  return number(seed, stream, pixel, shader::number_in_half(sample), d);
}
TEST(sequence, even_and_odd_samples_are_stratified_each) {
  EXPECT_TRUE(every_interval_has_its_sample(number_of_half<0>, 0));
  EXPECT_TRUE(every_interval_has_its_sample(number_of_half<1>, 0));
  EXPECT_FALSE(every_interval_has_its_sample(number_of_both, 0));  // twin: both together
  for (const uint64_t s :  // no two samples of a pixel have the same number
       {0ull, 1ull, 6ull, 7ull, (1ull << 32) - 1, 1ull << 32, (5ull << 32) + 11}) {
    const uint64_t n = shader::number_in_half(s);
    EXPECT_EQ(n >> 33 << 32 | (n & 0xffffffff) << 1 | (n >> 32 & 1), s);
  }
}

bool every_rectangle_has_its_sample(Numbers numbers, uint32_t other) {
  for (int k = 0; k <= 8; ++k)
    for (int a = 0; a <= k; ++a)
      for (uint64_t run : {0, 1, 100})
        for (uint32_t d = 0; d < 3 * sequence::kBlock; d += sequence::kBlock)
          if (!one_in_each_cell(numbers, run + 5, run << k, k, a, d, d + other)) return false;
  return true;
}
TEST(sequence, aligned_runs_put_one_sample_into_each_rectangle_of_a_block_s_first_dimensions) {
  EXPECT_TRUE(every_rectangle_has_its_sample(number, 1));
  // Twins: dimensions of two blocks, and independent numbers.
  EXPECT_FALSE(every_rectangle_has_its_sample(number, sequence::kBlock));
  EXPECT_FALSE(every_rectangle_has_its_sample(independent, 1));
}

// Whether the mean over many seeds of the estimates of the volume x + y + z < 1, which is 1/6, by
// `samples` samples is right within four standard errors. `fixed`: a single seed for all.
bool volume_is_right(uint32_t d, uint32_t e, uint32_t f, uint64_t samples, uint64_t fixed = 0) {
  constexpr int kSeeds = 4000;
  double sum = 0, squares = 0;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const uint64_t s = fixed ? fixed : seed;
    double inside = 0;
    for (uint64_t i = 0; i < samples; ++i)
      inside += number(s, 0, 0, i, d) + number(s, 0, 0, i, e) + number(s, 0, 0, i, f) < 1;
    const double error = inside / static_cast<double>(samples) - 1.0 / 6;
    sum += error;
    squares += error * error;
  }
  const double mean = sum / kSeeds;
  return std::abs(mean) <= 4 * std::sqrt((squares / kSeeds - mean * mean) / kSeeds);
}
TEST(sequence, means_over_seeds_are_unbiased_within_a_block_and_across_blocks) {
  for (uint64_t samples : {1, 3, 16}) {
    EXPECT_TRUE(volume_is_right(0, 1, 2, samples)) << samples;
    EXPECT_TRUE(volume_is_right(1, 2, 3, samples)) << samples;
    EXPECT_TRUE(volume_is_right(0, 4, 9, samples)) << samples;
  }
  EXPECT_FALSE(volume_is_right(0, 1, 2, 16, 1));  // twin: one scrambling alone
}

// Origin of one of two numbers.
struct Place {
  uint64_t seed = 0, stream = 0, pixel = 0, sample = 0;
  uint32_t d = 0;
};
// p-value for uniformity of the pairs (number at `varied` + a, number at `varied` + b) in the
// square; `varied` is the pixel or the seed.
double p_of_pairs(const Place& a, const Place& b, bool over_seeds) {
  constexpr size_t kSide = 16;
  const std::vector<double> even(kSide * kSide, 1.0 / (kSide * kSide));
  const auto bin = [&](const Place& at, uint64_t i) {
    const uint64_t seed = at.seed + (over_seeds ? 2 * i : 1);
    const uint64_t pixel = at.pixel + (over_seeds ? 3 : 2 * i);
    return static_cast<size_t>(kSide * number(seed, at.stream, pixel, at.sample, at.d));
  };
  return chi_square_of_samples(20000, even,
                               [&](uint64_t i) { return bin(a, i) * kSide + bin(b, i); })
      .p;
}
double least_p_of_pairs(const std::vector<std::pair<Place, Place>>& pairs) {
  double least = 1;
  for (const auto& [a, b] : pairs)
    for (const bool over_seeds : {false, true})
      least = std::min(least, p_of_pairs(a, b, over_seeds));
  return least;
}
TEST(sequence, pixels_streams_and_seeds_are_uncorrelated) {
  std::vector<std::pair<Place, Place>> pairs;
  for (uint64_t sample : {0, 5})
    for (uint32_t d : {0, 1, 3, 6}) {
      const Place here{.sample = sample, .d = d};
      pairs.push_back({here, {.pixel = 1, .sample = sample, .d = d}});
      pairs.push_back({here, {.pixel = uint64_t{1} << 32, .sample = sample, .d = d}});
      pairs.push_back({here, {.stream = 1, .sample = sample, .d = d}});
      pairs.push_back({here, {.seed = 1, .sample = sample, .d = d}});
      pairs.push_back({here, {.sample = sample + (uint64_t{1} << 32), .d = d}});
      pairs.push_back({here, {.pixel = 1, .sample = sample + 1, .d = d}});
      for (const uint64_t other : {sample ^ 1, sample + (uint64_t{1} << 32)})  // half, run
        pairs.push_back({{.sample = shader::number_in_half(sample), .d = d},
                         {.sample = shader::number_in_half(other), .d = d}});
    }
  EXPECT_GT(least_p_of_pairs(pairs), sidak(1e-3, 2 * pairs.size()));
  EXPECT_LT(least_p_of_pairs({{{}, {.sample = 1}}}), 1e-6);  // twin: samples of one pixel are
}

// Variance of the mean over 64 samples of a product of two centred numbers, relative to independent
// ones; over 4000 pixels, so accurate to about 5 %.
double variance_of_products(uint32_t d, uint32_t e) {
  constexpr int kPixels = 4000, kSamples = 64;
  double squares = 0;
  for (uint64_t pixel = 0; pixel < kPixels; ++pixel) {
    double sum = 0;
    for (uint64_t i = 0; i < kSamples; ++i)
      sum += (number(1, 0, pixel, i, d) - 0.5) * (number(1, 0, pixel, i, e) - 0.5);
    squares += sum * sum;
  }
  return squares * 144 / (kPixels * kSamples);
}
TEST(sequence, a_block_is_paired_much_better_than_at_random) {
  for (uint32_t d = 0; d < sequence::kBlock; ++d)
    for (uint32_t e = d + 1; e < sequence::kBlock; ++e)
      EXPECT_LT(variance_of_products(d, e), 0.05) << d << " " << e;
  EXPECT_GT(variance_of_products(1, 1), 1.8);  // twin: a dimension with itself
}

// p-value for uniformity of bits `shift` ... `shift` + 7 of the numbers of 50000 samples.
double p_of_byte(int shift, uint64_t keep) {
  const std::vector<double> even(256, 1.0 / 256);
  double least = 1;
  for (uint32_t d = 0; d < sequence::kBlock; ++d)
    least = std::min(least, chi_square_of_samples(50000, even, [&](uint64_t i) {
                              Sequence s(1, 0, 0, i);
                              s.seek(d);
                              return static_cast<size_t>((s.bits() & keep) >> shift & 255);
                            }).p);
  return least;
}
TEST(sequence, bits_below_those_of_the_sequence_are_filled_evenly) {
  for (int shift : {11, 16, 24}) EXPECT_GT(p_of_byte(shift, ~0ull), 1e-5);
  EXPECT_LT(p_of_byte(24, ~0ull << 32), 1e-6);  // twin: bits of the sequence alone
}

TEST(sequence, numbers_are_the_same_on_every_machine) {
  EXPECT_EQ(Sequence(1, 2, 3, 4).bits() >> 32, 0xdbccba38u);
  Sequence sequence(1, 2, 3, 70000);
  sequence.seek(7);
  EXPECT_EQ(sequence.bits(), 0xeaf2d611400dd8c1ull);
}

TEST(sequence, dimensions_are_the_same_in_order_and_sought) {
  Sequence in_order(1, 2, 3, 77);
  for (uint32_t d = 0; d < 20; ++d) EXPECT_EQ(in_order.uniform(), number(1, 2, 3, 77, d)) << d;
  Sequence again(1, 2, 3, 77);
  again.seek(6);
  again.bits();
  again.bits();  // into the next block
  EXPECT_EQ(again.uniform(), number(1, 2, 3, 77, 8));
}

}  // namespace tdpt::sequence_test
