// Makes foreign text safe to print in a message.
#pragma once
#include <string>
#include <string_view>

namespace tdpt {

/// The beginning of `text` on one line, with "..." if it is longer than `most` bytes. Control
/// characters, which could command a terminal, become '?'.
inline std::string shown(std::string_view text, size_t most = 80) {
  std::string out;
  for (const char c : text.substr(0, most))
    out += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
  return text.size() > most ? out + "..." : out;
}

}  // namespace tdpt
