// URIs of buffers and images.
#include "libcommon/scene/gltf/uri.h"

#include <fmt/format.h>

#include "libcommon/base/file.h"
#include "libcommon/base/shown.h"

namespace tdpt::gltf {
namespace {

int digit_of(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;  // '-' and '_': the URL-safe alphabet
  if (c == '/' || c == '_') return 63;
  return -1;
}

bool decode_base64(std::string_view text, std::string& out) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return false;
  out.reserve(text.size() / 4 * 3 + 2);
  uint32_t group = 0;
  int bits = 0;
  for (char c : text) {
    const int d = digit_of(c);
    if (d < 0) return false;
    group = (group << 6 | static_cast<uint32_t>(d)) & 0xFFFFFF;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      out += static_cast<char>((group >> bits) & 255);
    }
  }
  return true;
}

int hex_of(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

[[noreturn]] void nothing(const Namer& namer, const std::string& where, const std::string& message,
                          const std::string& what_is) {
  throw NothingThere(InputError(namer.file, where, message), what_is);
}

}  // namespace

std::string percent_decode(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && hex_of(text[i + 1]) >= 0 &&
        hex_of(text[i + 2]) >= 0) {
      out += static_cast<char>(hex_of(text[i + 1]) * 16 + hex_of(text[i + 2]));
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

std::string read_uri(const Document& document, const std::string& uri, const std::string& where,
                     std::string& file_read) {
  file_read.clear();
  const Namer namer{document.file, document.folder};
  if (uri.starts_with("data:")) {
    const size_t comma = uri.find(',');
    std::string out;
    if (comma == uri.npos || !uri.substr(0, comma).ends_with(";base64") ||
        !decode_base64(std::string_view(uri).substr(comma + 1), out))
      nothing(namer, where, "data URI cannot be decoded, expected \"data:...;base64,\" and base64",
              "a data URI that cannot be decoded");
    return out;
  }
  const std::string name = percent_decode(uri);
  const LocalFile file = local_file(namer, name, where);
  file_read = file.path;
  try {
    return read_file(file.real);
  } catch (const InputError&) {
    const std::string quoted = "\"" + shown(name) + "\"";
    nothing(namer, where, quoted + " cannot be read", "a file that cannot be read, " + quoted);
  }
}

}  // namespace tdpt::gltf
