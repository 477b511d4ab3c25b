// The container of a scene: .glb header and chunks (glTF 2.0, section 4.4), and URIs of what lies
// outside.
#include <fmt/format.h>
#include <charconv>

#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/scene/gltf/document.h"

namespace tdpt::gltf {
namespace {

uint32_t u32_at(std::string_view bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

constexpr uint32_t kJson = 0x4E4F534A, kBin = 0x004E4942;
constexpr size_t kHeader = 12, kChunkHeader = 8;

}  // namespace

Chunks split_chunks(std::string_view bytes, const std::string& file) {
  const auto fail = [&](const std::string& where, const std::string& message) {
    throw InputError(file, where, message);
  };
  if (bytes.empty()) fail("", "is empty, expected a glTF 2.0 scene");
  if (!bytes.starts_with("glTF")) {
    const size_t first = bytes.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
    if (first == bytes.npos || bytes[first] != '{')
      fail("", std::string("is no glTF scene, expected \"glTF\" (.glb) or \"{\" (.gltf) at its "
                           "start: ") +
                   kAdviceOnOthers);
    return {bytes, {}, false};
  }
  if (bytes.size() < kHeader)
    fail("header", fmt::format("is cut short after {} bytes, expected {}", bytes.size(), kHeader));
  const uint32_t version = u32_at(bytes, 4), length = u32_at(bytes, 8);
  if (version != 2) fail("header", fmt::format("version is {}, expected 2", version));
  if (length > bytes.size())
    fail("header",
         fmt::format("the file is cut short: {} bytes, expected {}", bytes.size(), length));
  bytes = bytes.substr(0, length);

  Chunks chunks;
  size_t at = kHeader;
  // Anything after the binary chunk is ignored.
  for (size_t k = 0; k < 2 && at < bytes.size(); ++k) {
    const std::string where = place("chunk", k);
    const size_t left = bytes.size() - at;
    if (left < kChunkHeader) {
      if (k > 0 && left < 4) break;  // padding
      fail(where, fmt::format("is cut short: {}, expected a header of {}", counted(left, "byte"),
                              kChunkHeader));
    }
    const uint32_t size = u32_at(bytes, at), type = u32_at(bytes, at + 4);
    if (size > left - kChunkHeader)
      fail(where, fmt::format("declares {}, but {} are left in the file", counted(size, "byte"),
                              left - kChunkHeader));
    const std::string_view content = bytes.substr(at + kChunkHeader, size);
    if (k == 0) {
      if (type != kJson) fail(where, "is not JSON, expected the JSON chunk first");
      chunks.json = content;
    } else if (type == kBin) {
      chunks.bin = content;
      chunks.has_bin = true;
    }
    at += kChunkHeader + size;
  }
  while (!chunks.json.empty() && chunks.json.back() == '\0') chunks.json.remove_suffix(1);
  if (chunks.json.empty()) fail("chunk[0]", "is missing or empty, expected the JSON chunk");
  return chunks;
}

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

[[noreturn]] void nothing(const Namer& namer, const std::string& where, const std::string& message,
                          const std::string& what_is) {
  throw NothingThere(InputError(namer.file, where, message), what_is);
}

}  // namespace

std::string percent_decode(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    uint8_t byte = 0;
    const char* const end = text.data() + i + 3;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(text.data() + i + 1, end, byte, 16).ptr == end) {
      out += static_cast<char>(byte);
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
