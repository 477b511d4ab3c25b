#pragma once
#include <cctype>
#include <string>
#include <string_view>

namespace tdpt {

/// ".glb" of "rooms/Room.GLB": in small letters, as programs on other systems write capitals.
inline std::string suffix_of(std::string_view path) {
  const size_t dot = path.find_last_of("./");
  if (dot == path.npos || path[dot] == '/') return "";
  std::string suffix(path.substr(dot));
  for (char& c : suffix) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return suffix;
}

}  // namespace tdpt
