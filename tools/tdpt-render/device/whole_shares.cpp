#include "tools/tdpt-render/device/whole_shares.h"

#include <algorithm>
#include <numeric>

namespace tdpt {

std::vector<uint64_t> whole_shares(const std::vector<double>& weights, uint64_t units) {
  const auto some = static_cast<uint64_t>(
      std::count_if(weights.begin(), weights.end(), [](double w) { return w > 0; }));
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  std::vector<uint64_t> begin{0};
  double sum = 0;
  uint64_t before = 0;  // nonzero entries so far, each of which has one unit in advance
  for (const double w : weights) {
    sum += w;
    before += w > 0;
    const double share = before == some ? 1 : std::min(sum / total, 1.0);
    begin.push_back(before + static_cast<uint64_t>(share * static_cast<double>(units - some)));
  }
  return begin;
}

namespace {

constexpr uint64_t kAll = uint64_t{1} << 32;

uint32_t word(uint64_t place) {
  return static_cast<uint32_t>(std::min(place, kAll - 1));
}

}  // namespace

WordTable add_word_table(const std::vector<double>& weights, std::vector<uint32_t>& words) {
  const std::vector<uint64_t> begin = whole_shares(weights, kAll);
  const uint64_t n = weights.size();
  WordTable table;
  table.entries = static_cast<uint32_t>(n);
  table.begin = static_cast<uint32_t>(words.size());
  for (const uint64_t place : begin) words.push_back(word(place));
  table.guide = static_cast<uint32_t>(words.size());
  uint64_t entry = 0;
  for (uint64_t slot = 0; slot <= n; ++slot) {
    const uint64_t first = std::min((slot * kAll + n - 1) / n, kAll - 2);
    while (entry + 1 < n && begin[entry + 1] <= first) ++entry;
    words.push_back(static_cast<uint32_t>(entry));
  }
  return table;
}

uint64_t WordTable::words_of(const std::vector<uint32_t>& words, uint32_t entry) const {
  const uint64_t end = entry + 1 == entries ? kAll : words[begin + entry + 1];
  return end - words[begin + entry];
}

}  // namespace tdpt
