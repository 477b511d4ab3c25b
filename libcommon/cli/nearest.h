// What a misspelt word probably stands for.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace tdpt::cli {

/// That of `words` which takes the fewest slips of the finger to `given` (a letter more, one less,
/// another one, two that changed places; capitals are none): one, or one for every three letters;
/// else the only one that begins with `given`, three letters at least; else "". Of several as near
/// the first.
std::string nearest(std::string_view given, const std::vector<std::string>& words);

}  // namespace tdpt::cli
