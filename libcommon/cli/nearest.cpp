// The distance is the optimal string alignment variant of Damerau-Levenshtein (no letter is edited
// twice): D(i, j) is the distance between the first i letters of one word and the first j of the
// other.
#include "libcommon/cli/nearest.h"

#include <algorithm>
#include <cctype>

namespace tdpt::cli {
namespace {

std::string in_small_letters(std::string_view word) {
  std::string small(word);
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return small;
}

size_t distance(const std::string& a, const std::string& b) {
  std::vector<size_t> before_last, last, row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    before_last = std::move(last);
    last = row;
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t another = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, another});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::string only_one_that_begins_with(const std::string& start,
                                      const std::vector<std::string>& words) {
  std::string found;
  if (start.size() < 3) return found;
  for (const std::string& word : words) {
    if (!in_small_letters(word).starts_with(start)) continue;
    if (!found.empty()) return {};
    found = word;
  }
  return found;
}

}  // namespace

std::string nearest(std::string_view given, const std::vector<std::string>& words) {
  const std::string small = in_small_letters(given.substr(0, 64));
  size_t least = std::max<size_t>(1, small.size() / 3) + 1;
  std::string found;
  for (const std::string& word : words)
    if (const size_t d = distance(small, in_small_letters(word)); d < least && d < small.size()) {
      least = d;
      found = word;
    }
  return found.empty() ? only_one_that_begins_with(small, words) : found;
}

}  // namespace tdpt::cli
