// Weights as integers, from which kernels sample with exactly the probability they report
// [shaders/shared/path/sky.h].
#pragma once
#include <cstdint>
#include <vector>

namespace tdpt {

/// n + 1 bounds in 0 ... units: entry i of n has the integers in [bound i, bound i+1), in
/// proportion to its weight to within rounding, and at least one if the weight is not 0. Some
/// weight must not be 0, and at most `units` of them.
std::vector<uint64_t> whole_shares(const std::vector<double>& weights, uint64_t units);

/// Appends to `words` a table that divides all 2^32 words by `weights`: where each entry begins,
/// then a guide table for the search.
struct WordTable {
  uint32_t begin = 0, guide = 0, entries = 0;
  uint64_t words_of(const std::vector<uint32_t>& words, uint32_t entry) const;
};
WordTable add_word_table(const std::vector<double>& weights, std::vector<uint32_t>& words);

}  // namespace tdpt
