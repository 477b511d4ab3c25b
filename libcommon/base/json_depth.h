// Nesting depth of JSON from foreign files, checked before parsing: the code that handles the
// values is recursive.
#pragma once
#include <string_view>

namespace tdpt {

/// Whether objects and arrays are nested more than 32 deep.
inline bool nested_too_deep(std::string_view json) {
  int depth = 0;
  bool in_text = false;
  for (size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_text) {
      if (c == '\\') ++i;
      if (c == '"') in_text = false;
    } else if (c == '"') {
      in_text = true;
    } else if (c == '{' || c == '[') {
      if (++depth > 32) return true;
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return false;
}

}  // namespace tdpt
