// URIs of buffers and images. A scene may be untrusted, so it has access only to itself and to
// files in its own folder or below.
#include "libcommon/scene/gltf/uri.h"

#include <fmt/format.h>
#include <filesystem>

#include "libcommon/base/file.h"
#include "libcommon/base/shown.h"

namespace tdpt::gltf {
namespace {

namespace fs = std::filesystem;

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

bool is_below(const fs::path& file, const fs::path& folder) {
  const auto [rest, unused] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
  return rest == folder.end();
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

LocalFile local_file(const Namer& namer, const std::string& name, const std::string& where) {
  const auto fail = [&](const std::string& message) {
    throw InputError(namer.file, where, message);
  };
  const std::string quoted = "\"" + shown(name) + "\"";
  const size_t colon = name.find(':'), slash = name.find_first_of("/?#");
  bool outside = name.empty() || name.front() == '/' ||
                 name.find_first_of(std::string_view("\\\0", 2)) != name.npos ||
                 (colon != name.npos && colon < slash);
  std::error_code error;
  const fs::path folder = fs::canonical(namer.folder, error);
  outside = outside || !is_below((folder / name).lexically_normal(), folder);
  if (outside) fail(quoted + " is not a file in the scene's folder, which is all that is read");
  if (namer.folder.empty())
    fail(quoted + " is another file, expected a scene in one piece on standard input");
  const fs::path file = fs::canonical(folder / name, error);
  if (error)
    nothing(namer, where, quoted + " cannot be opened: " + error.message(),
            "a file that is missing, " + quoted);
  if (!is_below(file, folder))
    fail(quoted + " leads out of the scene's folder, which is all that is read");
  if (!fs::is_regular_file(file, error)) fail(quoted + " is no regular file");
  return {(fs::path(namer.folder) / name).lexically_normal().string(), file.string()};
}

std::string folder_of(const std::string& path) {
  if (path == "-") return "";
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
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
