#include "tools/tdpt-render/device/tables.h"

#include <gtest/gtest.h>

namespace tdpt::whole_shares_test {

TEST(whole_shares, are_in_proportion_and_never_none) {
  const std::vector<double> weights{1, 0, 1e-12, 3, 0};
  const std::vector<uint64_t> begin = whole_shares(weights, 255);
  ASSERT_EQ(begin.size(), 6u);
  EXPECT_EQ(begin.front(), 0u);
  EXPECT_EQ(begin.back(), 255u);
  EXPECT_NEAR(static_cast<double>(begin[1]), 64, 1);
  EXPECT_EQ(begin[2], begin[1]);
  EXPECT_NEAR(static_cast<double>(begin[3] - begin[2]), 1.5, 0.5);
  EXPECT_EQ(begin[5], begin[4]);
  EXPECT_EQ(whole_shares({7}, 255), (std::vector<uint64_t>{0, 255}));
  for (const uint64_t n : {16u, 255u}) {
    const std::vector<uint64_t> even = whole_shares(std::vector<double>(n, 0.3), 255);
    for (size_t i = 0; i < n; ++i) {
      EXPECT_GE(even[i + 1] - even[i], 255 / n);
      EXPECT_LE(even[i + 1] - even[i], 255 / n + 1);
    }
  }
}

// As in kernels: the two ends of a guide slot enclose the entry of each of its words.
TEST(word_table, guides_to_every_word) {
  std::vector<double> weights(1000, 1e-3);
  for (size_t i = 0; i < weights.size(); i += 7) weights[i] = 0;
  weights[300] = 1e6;
  weights[301] = 1e3;
  for (const std::vector<double>& some : {weights, {1.0}, {0, 0, 1.0, 0}, {1e-30, 1, 1e-30}}) {
    std::vector<uint32_t> words(5);
    const WordTable t = add_word_table(some, words);
    const uint64_t n = some.size();
    ASSERT_EQ(t.entries, n);
    uint64_t all = 0;
    for (uint32_t i = 0; i < n; ++i) {
      const uint64_t own = t.words_of(words, i);
      if (i + 1 < n) all += own;
      if (own == 0 || words[t.begin + i] == ~0u) continue;
      EXPECT_GT(some[i], 0);
      const uint64_t first = words[t.begin + i];
      for (const uint64_t word : {first, first + own - 1}) {
        if (word > 0xFFFFFFFE) continue;
        const uint64_t slot = word * n >> 32;
        EXPECT_LE(words[t.guide + slot], i);
        EXPECT_GE(words[t.guide + slot + 1], i);
      }
    }
    EXPECT_LE(all, uint64_t{1} << 32);
  }
}

}  // namespace tdpt::whole_shares_test
