// Weights as whole numbers, from which kernels draw with exactly the probability they tell
// [shaders/shared/path/sky.h].
#pragma once
#include <cstdint>
#include <vector>

namespace tdpt {

/// n + 1 places in 0 ... units: entry i of n has those from [i] to [i+1], in proportion to its
/// weight up to one and some, at least one where the weight is not 0. Not all weights are 0, and
/// there are no more of them than units.
std::vector<uint64_t> whole_shares(const std::vector<double>& weights, uint64_t units);

/// Puts a table of all 2^32 words for `weights` behind `words`: where the entries begin, then a
/// guide to them.
struct WordTable {
  uint32_t begin = 0, guide = 0, entries = 0;
  uint64_t words_of(const std::vector<uint32_t>& words, uint32_t entry) const;
};
WordTable add_word_table(const std::vector<double>& weights, std::vector<uint32_t>& words);

}  // namespace tdpt
