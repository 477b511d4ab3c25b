// Text for people: numbers with their nouns, foreign text that is safe to print, words for a shell.
// Files, JSON and provenance format their numbers themselves.
#pragma once
#include <cctype>
#include <initializer_list>
#include <string>
#include <string_view>

namespace tdpt {

/// `digits` significant digits, without an exponent from 1e-4 to 1e7: "0.00031", "140", "5300000".
std::string number_words(double value, int digits = 3);
/// "15 %" of 0.153, "100 %" of 1.
std::string percent_words(double share, int digits = 2);
/// "4.7 s", "3 minutes", "12 hours": two digits.
std::string duration_words(double seconds);

/// "1 mesh", "3 meshes".
template <class Number>
std::string counted(Number n, std::string_view noun) {
  const std::string words = std::to_string(n) + ' ' + std::string(noun);
  if (n == 1) return words;
  for (const std::string_view hissing : {"s", "x", "ch", "sh"})
    if (noun.ends_with(hissing)) return words + "es";
  return words + "s";
}

/// The beginning of `text` on one line, with "..." if it is longer than `most` bytes. Control
/// characters, which could command a terminal, become '?'.
inline std::string shown(std::string_view text, size_t most = 80) {
  std::string out;
  for (const char c : text.substr(0, most))
    out += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
  return text.size() > most ? out + "..." : out;
}

/// `text` with every occurrence of `from`, which is not empty, replaced by `to`.
inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

/// ".glb" of "rooms/Room.GLB": in small letters, as programs on other systems write capitals.
inline std::string suffix_of(std::string_view path) {
  const size_t dot = path.find_last_of("./");
  if (dot == path.npos || path[dot] == '/') return "";
  std::string suffix(path.substr(dot));
  for (char& c : suffix) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return suffix;
}

/// `word` itself, or in single quotes if a shell would split or expand it.
std::string shell_quoted(const std::string& word);

}  // namespace tdpt
