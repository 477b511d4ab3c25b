// Suggests what a misspelt word stands for.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace tdpt::cli {

/// The closest of `words` by edit distance to `given`: insertions, deletions, substitutions and
/// transpositions count 1 each, letter case 0. At most one edit, or one for every three letters.
/// Otherwise the only word that begins with `given`, if that has at least three letters; otherwise
/// "". Ties go to the first.
std::string nearest(std::string_view given, const std::vector<std::string>& words);

/// Of the names of `options` the one that other renderers call `given`, else the nearest.
std::string option_meant(std::string_view given, const std::vector<std::string>& options);

}  // namespace tdpt::cli
