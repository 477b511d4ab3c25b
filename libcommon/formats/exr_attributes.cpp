// Layout ("OpenEXR File Layout"): magic number and version (8 bytes), then attributes: name, type
// (zero-terminated text), size (4 bytes), value. A 0 ends a header; in a multi-part file an empty
// header ends the headers.
#include "libcommon/formats/picture_bounds.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "libcommon/base/words.h"

namespace tdpt {
namespace {

// Sizes of the types with a fixed size. Other types except those below may have any size.
const std::map<std::string_view, uint32_t>& fixed_sizes() {
  static const std::map<std::string_view, uint32_t> sizes = {{"box2f", 16},
                                                             {"box2i", 16},
                                                             {"chromaticities", 32},
                                                             {"compression", 1},
                                                             {"deepImageState", 1},
                                                             {"double", 8},
                                                             {"envmap", 1},
                                                             {"float", 4},
                                                             {"int", 4},
                                                             {"keycode", 28},
                                                             {"lineOrder", 1},
                                                             {"m33d", 72},
                                                             {"m33f", 36},
                                                             {"m44d", 128},
                                                             {"m44f", 64},
                                                             {"rational", 8},
                                                             {"tiledesc", 9},
                                                             {"timecode", 8},
                                                             {"v2d", 16},
                                                             {"v2f", 8},
                                                             {"v2i", 8},
                                                             {"v3d", 24},
                                                             {"v3f", 12},
                                                             {"v3i", 12}};
  return sizes;
}

class Walk {
 public:
  explicit Walk(std::string_view bytes) : bytes_(bytes) {}

  bool has(size_t n) const { return bytes_.size() - at_ >= n; }
  size_t left() const { return bytes_.size() - at_; }
  std::string_view take(size_t n) {
    const std::string_view part = bytes_.substr(at_, n);
    at_ += part.size();
    return part;
  }
  std::string_view text() {
    const std::string_view all = bytes_.substr(at_);
    const std::string_view found = all.substr(0, all.find('\0'));
    at_ += std::min(found.size() + 1, all.size());
    return found;
  }
  uint32_t u32() {
    uint32_t value = 0;
    const std::string_view part = take(4);
    for (size_t i = part.size(); i-- > 0;) value = value << 8 | static_cast<unsigned char>(part[i]);
    return value;
  }

 private:
  std::string_view bytes_;
  size_t at_ = 0;
};

// Channels, each a name and 16 bytes, terminated by an empty name.
bool is_channel_list(std::string_view value) {
  Walk walk(value);
  while (walk.left() > 0) {
    if (walk.text().empty()) return walk.left() == 0;
    if (!walk.has(16)) return false;
    walk.take(16);
  }
  return false;
}

// Strings, each preceded by its length.
bool is_list_of_strings(std::string_view value) {
  Walk walk(value);
  while (walk.left() > 0) {
    if (!walk.has(4)) return false;
    const uint32_t length = walk.u32();
    if (!walk.has(length)) return false;
    walk.take(length);
  }
  return true;
}

bool is_sound(std::string_view type, std::string_view value) {
  const auto fixed = fixed_sizes().find(type);
  if (fixed != fixed_sizes().end()) return value.size() == fixed->second;
  if (type == "chlist") return is_channel_list(value);
  if (type == "stringvector") return is_list_of_strings(value);
  if (type == "floatvector") return value.size() % 4 == 0;
  return true;
}

struct Headers {
  std::string fault{};
  size_t end = 0;
  std::string compressions{};  // one of each header
  std::map<std::string, std::string> strings{};
};

Headers walk_through(std::string_view bytes) {
  Headers headers{"the file ends too early"};
  if (bytes.size() < 8) return headers;
  const bool many_parts = (static_cast<unsigned char>(bytes[5]) & 0x10) != 0;
  Walk walk(bytes);
  walk.take(8);
  bool in_header = false;  // after its first attribute
  while (walk.left() > 0) {
    const std::string_view name = walk.text();
    if (name.empty()) {
      headers.end = bytes.size() - walk.left();
      if (!many_parts || !in_header) {
        headers.fault.clear();
        return headers;
      }
      in_header = false;
      continue;
    }
    in_header = true;
    const std::string_view type = walk.text();
    if (!walk.has(4)) break;
    const uint32_t size = walk.u32();
    if (!walk.has(size)) {
      headers.fault = fmt::format("attribute {} of {} bytes in a file with {} more",
                                  shown(name, 40), size, walk.left());
      break;
    }
    const std::string_view value = walk.take(size);
    if (!is_sound(type, value)) {
      headers.fault =
          fmt::format("attribute {} of {} bytes is no {}", shown(name, 40), size, shown(type, 40));
      break;
    }
    if (type == "compression") headers.compressions += value;
    if (type == "string") headers.strings.emplace(name, value);
  }
  return headers;
}

}  // namespace

std::string fault_of_exr_attributes(std::string_view bytes) {
  return walk_through(bytes).fault;
}

std::string exr_compressions(std::string_view bytes) {
  return walk_through(bytes).compressions;
}

size_t end_of_exr_headers(std::string_view bytes) {
  return walk_through(bytes).end;
}

std::map<std::string, std::string> string_attributes_of_file(const std::string& path) {
  constexpr size_t kFirst = 1 << 16, kLongest = 1 << 26;
  std::ifstream file(path, std::ios::binary);
  std::string bytes;
  for (size_t size = kFirst; file && size <= kLongest; size *= 2) {
    const size_t had = bytes.size();
    bytes.resize(size);
    file.read(bytes.data() + had, static_cast<std::streamsize>(size - had));
    bytes.resize(had + static_cast<size_t>(file.gcount()));
    if (!bytes.starts_with("\x76\x2f\x31\x01")) return {};
    Headers headers = walk_through(bytes);
    if (headers.end > 0) return std::move(headers.strings);
  }
  return {};
}

}  // namespace tdpt
