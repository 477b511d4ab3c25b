// Film sums by 32-bit atomics equal those of FixedSum.
#include <gtest/gtest.h>

#include <cstring>
#include <thread>

#include "libcommon/film/fixed_sum.h"
#include "libcommon/gpu/kernel.h"
#include "libcommon/math/rng.h"
#include "libcommon/math/vec.h"
#include "shaders/film_sum_test.h"
#include "shaders/shared/rng.h"

namespace tdpt {
namespace shader {

struct ScalarFilm {
  uint* film_words;

#include "shaders/shared/path/film_sum.h"
  // Separate: each begins with language.h.
#include "shaders/shared/path/film_sum_test.h"
};

}  // namespace shader

namespace film_sum_test {

constexpr uint32_t kGroups = 256, kInvocations = 64 * kGroups, kSums = 15, kWords = 4 * kSums;

Units units_of(const shader::uvec4& words) {
  Units units = 0;
  for (uint32_t k = 4; k > 0; --k) units = units << 32 | words[k - 1];
  return units;
}
shader::uvec4 words_of(Units units) {
  shader::uvec4 words;
  for (uint32_t k = 0; k < 4; ++k) words[k] = static_cast<uint32_t>(units >> (32 * k));
  return words;
}

// Words of FixedSum, and a flag for each value that fits.
struct Film {
  std::vector<uint32_t> words = std::vector<uint32_t>(kWords);
  std::vector<uint32_t> held = std::vector<uint32_t>(kInvocations);
  friend bool operator==(const Film&, const Film&) = default;
};
Film expected() {
  std::vector<FixedSum> sums(kSums);
  Film film;
  const shader::ScalarFilm scalar{nullptr};
  for (uint32_t i = 0; i < kInvocations; ++i) {
    shader::Rng rng = shader::rng_of(5, 0, i, 0);
    const Vec3d value(scalar.film_trial_radiance(rng));
    const uint64_t coin = shader::random_bits(rng);
    std::array<Units, 3> units;
    film.held[i] = 1;
    for (int c = 0; c < 3; ++c)
      film.held[i] &= to_units(value[c], 0x1p64, std::rotl(coin, 21 * c), units[size_t(c)]);
    for (size_t c = 0; c < 3 && film.held[i] != 0; ++c) sums[3 * (i % 5) + c].add(units[c]);
  }
  for (size_t k = 0; k < kSums; ++k)
    for (uint32_t word = 0; word < 4; ++word)
      film.words[4 * k + word] = words_of(sums[k].units())[word];
  return film;
}
Film by_scalar(uint32_t step) {
  Film film;
  const shader::ScalarFilm scalar{film.words.data()};
  for (uint32_t n = 0; n < kInvocations; ++n) {
    const uint32_t i = n * step % kInvocations;
    film.held[i] = scalar.film_trial(i);
  }
  return film;
}
Film by_device() {
  gpu::Device device = gpu::Device::open();
  const Film empty;
  const gpu::Buffer words(device, empty.words), held(device, empty.held);
  const gpu::Kernel kernel(device, shader::film_sum_test_spv, {words, held});
  device.run([&](gpu::Commands& c) { c.dispatch(kernel, {}, kGroups); });
  return {words.download<uint32_t>(kWords), held.download<uint32_t>(kInvocations)};
}

TEST(film_sum, of_a_device_and_its_twin_is_the_fixed_sum_whatever_the_order) {
  const Film film = expected();
  const auto held = std::count(film.held.begin(), film.held.end(), 1u);
  EXPECT_GT(held, kInvocations / 2);
  EXPECT_LT(held, kInvocations);
  EXPECT_EQ(by_scalar(1), film);
  EXPECT_EQ(by_scalar(4097), film);
  EXPECT_EQ(by_device(), film);
}
TEST(film_sum, twin_one_unit_more_is_seen) {
  Film film = by_scalar(1);
  shader::ScalarFilm{film.words.data()}.film_add_units(8, shader::uvec4(1, 0, 0, 0));
  EXPECT_NE(film, expected());
}

TEST(film_sum, units_are_those_of_doubles_for_the_same_coin) {
  Rng rng(51, 0, 0);
  for (int i = 0; i < 1000000; ++i) {
    // From the least normal number to those that do not fit, and close to whole units.
    const uint32_t exponent = 33 + static_cast<uint32_t>(rng.uniform() * 150);
    const auto digits = static_cast<uint32_t>(rng.bits()) >> (9 + i % 24);
    const float value = shader::uintBitsToFloat(exponent << 23 | (digits & 0x7FFFFF));
    const uint64_t coin = i % 8 == 0 ? ~uint64_t{0} : i % 8 == 1 ? 0 : rng.bits();
    Units units = 0;
    shader::uvec4 mine;
    const bool held = to_units(value, 0x1p64, coin, units);
    ASSERT_EQ(shader::ScalarFilm{nullptr}.film_units(value, coin, mine), held) << value;
    if (held) {
      ASSERT_TRUE(units_of(mine) == units) << value << " " << coin;
    }
  }
}

// Stochastic rounding is unbiased over all coins, including the digits below 2^-32 of a unit.
TEST(film_sum, values_below_a_unit_keep_their_mean) {
  for (const double share : {0.75, 1.0 / 3, 1e-3, 1e-9, 3e-12, 0x1p-62}) {
    const auto value = static_cast<float>(std::ldexp(share, -64));
    // A unit is added below a coin that equals the value's fraction of a unit, to its precision.
    const auto least = static_cast<uint64_t>(std::ldexp(double{value}, 128));
    shader::uvec4 units;
    EXPECT_TRUE(shader::ScalarFilm{nullptr}.film_units(value, least - 1, units));
    EXPECT_EQ(units[0], 1u) << share;
    EXPECT_TRUE(shader::ScalarFilm{nullptr}.film_units(value, least, units));
    EXPECT_EQ(units[0], 0u) << share;
  }
}

TEST(film_sum, what_cannot_be_held_is_refused) {
  shader::uvec4 units;
  for (const float value :
       {-1.0f, -1e-38f, -1e-42f, 0x1p46f, 3e38f, INFINITY, -INFINITY, NAN, -NAN}) {
    EXPECT_FALSE(shader::ScalarFilm{nullptr}.film_units(value, 0, units)) << value;
    EXPECT_TRUE(units_of(units) == 0) << value;
  }
  for (const float value : {0.0f, -0.0f, 1e-42f}) {
    EXPECT_TRUE(shader::ScalarFilm{nullptr}.film_units(value, 0, units)) << value;
    EXPECT_TRUE(units_of(units) == 0) << value;
  }
  EXPECT_TRUE(shader::ScalarFilm{nullptr}.film_units(std::nextafter(0x1p46f, 0.0f), 0, units));
  EXPECT_TRUE(units_of(units) == Units{0xFFFFFF} << 86);
}

TEST(film_sum, threads_carry_every_wrap_once) {
  std::vector<uint32_t> words(4);
  FixedSum sum;
  const shader::ScalarFilm scalar{words.data()};
  constexpr uint64_t kOfThread = 40000;
  const auto units = [](uint64_t i) {
    // Full words, so that each carries, with empty ones between them.
    const Units all = (Units{mix64(i)} << 64 | mix64(i + 1)) >> 24;
    return i % 3 == 0 ? all | 0xFFFFFFFF : i % 3 == 1 ? (Units{1} << 96) - 1 : all << 20 >> 20;
  };
  std::vector<std::thread> threads;
  for (uint64_t t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (uint64_t i = 0; i < kOfThread; ++i)
        EXPECT_TRUE(scalar.film_add_units(0, words_of(units(t * kOfThread + i))));
    });
  for (std::thread& t : threads) t.join();
  for (uint64_t i = 0; i < 4 * kOfThread; ++i) sum.add(units(i));
  EXPECT_TRUE(units_of({words[0], words[1], words[2], words[3]}) == sum.units());
  // Overflow is reported.
  const Units rest = ~sum.units();
  EXPECT_TRUE(scalar.film_add_units(0, words_of(rest)));
  EXPECT_FALSE(scalar.film_add_units(0, words_of(1)));
  EXPECT_EQ(words, std::vector<uint32_t>(4));
}

}  // namespace film_sum_test
}  // namespace tdpt
