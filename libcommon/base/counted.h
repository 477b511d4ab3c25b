// Numbers with their nouns, in messages.
#pragma once
#include <initializer_list>
#include <string>
#include <string_view>

namespace tdpt {

/// "1 mesh", "3 meshes".
template <class Number>
std::string counted(Number n, std::string_view noun) {
  const std::string words = std::to_string(n) + ' ' + std::string(noun);
  if (n == 1) return words;
  for (const std::string_view hissing : {"s", "x", "ch", "sh"})
    if (noun.ends_with(hissing)) return words + "es";
  return words + "s";
}

}  // namespace tdpt
