// Film sums by 32-bit atomics equal those of FixedSum. That a device's equal the scalar build's:
// device_bytes.
#include <gtest/gtest.h>

#include <thread>

#include "libcommon/film/fixed_sum.h"
#include "libcommon/math/rng.h"
#include "shaders/shared/rng.h"

namespace tdpt {
namespace shader {

struct ScalarFilm {
  uint* film_words;
#include "shaders/shared/path/film_sum.h"
};

}  // namespace shader

namespace film_sum_test {

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

TEST(film_sum, units_are_those_of_doubles_for_the_same_coin) {
  const shader::ScalarFilm scalar{nullptr};
  Rng rng(51, 0, 0);
  int refused = 0;
  for (int i = 0; i < 200000; ++i) {
    // From the least normal number to those that do not fit, and close to whole units.
    const uint32_t exponent = 33 + static_cast<uint32_t>(rng.uniform() * 150);
    const auto digits = static_cast<uint32_t>(rng.bits()) >> (9 + i % 24);
    const float value = shader::uintBitsToFloat(exponent << 23 | (digits & 0x7FFFFF));
    const uint64_t coin = i % 8 == 0 ? ~uint64_t{0} : i % 8 == 1 ? 0 : rng.bits();
    Units units = 0;
    shader::uvec4 mine;
    const bool held = to_units(value, 0x1p64, coin, units);
    ASSERT_EQ(scalar.film_units(value, coin, mine), held) << value;
    refused += !held;
    if (held) {
      ASSERT_TRUE(units_of(mine) == units) << value << " " << coin;
    }
  }
  EXPECT_GT(refused, 1000);
}

TEST(film_sum, what_cannot_be_held_is_refused) {
  const shader::ScalarFilm scalar{nullptr};
  shader::uvec4 units;
  for (const float value :
       {-1.0f, -1e-38f, -1e-42f, 0x1p46f, 3e38f, INFINITY, -INFINITY, NAN, -NAN}) {
    EXPECT_FALSE(scalar.film_units(value, 0, units)) << value;
    EXPECT_TRUE(units_of(units) == 0) << value;
  }
  for (const float value : {0.0f, -0.0f, 1e-42f}) {
    EXPECT_TRUE(scalar.film_units(value, 0, units)) << value;
    EXPECT_TRUE(units_of(units) == 0) << value;
  }
  EXPECT_TRUE(scalar.film_units(std::nextafter(0x1p46f, 0.0f), 0, units));
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
  EXPECT_TRUE(scalar.film_add_units(0, words_of(~sum.units())));
  EXPECT_FALSE(scalar.film_add_units(0, words_of(1)));
  EXPECT_EQ(words, std::vector<uint32_t>(4));
}

}  // namespace film_sum_test
}  // namespace tdpt
