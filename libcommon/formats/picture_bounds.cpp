// Layout of a file ("OpenEXR File Layout"): magic number and version (8 bytes), then attributes:
// name, type (zero-terminated text), size (4 bytes), value. A 0 ends a header; in a multi-part file
// an empty header ends the headers.
//
// Largest expansion of a byte by each compression:
//   RLE   2 bytes stand for 128 equal ones                                              64
//   ZIP   deflate: 258 bytes in 2 bits                                                1032
//   PXR24 the same; floats have three bytes by then                                   1376
//   PIZ   Huffman codes: 255 numbers of 2 bytes in a bit and a count of 8              454
//   B44   3 bytes for 4 x 4 numbers of 2 bytes                                          11
//   DWA   8 x 8 floats in two numbers of 2 bytes, deflated; or runs, deflated        66048
#include "libcommon/formats/picture_bounds.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <optional>
#include <utility>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVersion.h>
#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/words.h"
#include "libcommon/formats/picture.h"

namespace tdpt::exr {
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

}  // namespace

Headers headers_of(std::string_view bytes) {
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

namespace {

// Samples are 4 bytes; the library stores the size of a chunk as int.
constexpr int64_t most_samples_in_a_chunk = int64_t(1) << 27;
constexpr int64_t most_samples_in_a_tile = int64_t(1) << 26;
// Allowance for small pictures in large tiles, and for large pictures cropped to a small window.
constexpr int64_t bytes_for_nothing = int64_t(1) << 22;
constexpr int64_t pixels_around_nothing = int64_t(1) << 24, pixels_around_each = 4096;

// Largest expansion of one byte of the file.
int64_t expansion(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION:
      return 1;
    case Imf::RLE_COMPRESSION:
      return 64;
    case Imf::PXR24_COMPRESSION:
      return 1376;
    case Imf::PIZ_COMPRESSION:
      return 454;
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
      return 11;
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      return 66048;
    default:
      return 1032;
  }
}

// Scan lines per chunk.
int64_t rows_in_chunk(Imf::Compression compression) {
  switch (compression) {
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
      return 32;
    case Imf::DWAB_COMPRESSION:
      return 256;
    default:
      return 1;
  }
}

int64_t rows_decoded_at_once(const Imf::Header& header) {
  return header.hasTileDescription() ? header.tileDescription().ySize
                                     : rows_in_chunk(header.compression());
}

std::string words_of(const Vec3<int64_t>& size, size_t layers) {
  return fmt::format("{} x {} pixels{}", size.x, size.y,
                     layers > 1 ? fmt::format(" of {} layers", layers) : "");
}

struct ChannelSums {
  int64_t count = 0, bytes_of_pixel = 0;
};

ChannelSums channels_of(const Imf::Header& header) {
  ChannelSums sums;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    ++sums.count;
    sums.bytes_of_pixel += c.channel().type == Imf::HALF ? 2 : 4;
  }
  return sums;
}

void check_windows(const Imf::Header& header, const std::string& name) {
  for (const auto& [box, what] : {std::pair(header.displayWindow(), "display window"),
                                  std::pair(header.dataWindow(), "data window")}) {
    const auto size = extent(box);
    if (size.x < 1 || size.y < 1 || size.x > largest_side || size.y > largest_side)
      throw InputError(
          name, what,
          fmt::format("is {} x {} pixels, expected 1 to {} a side", size.x, size.y, largest_side));
  }
}

// Pixels of the data window, rounded up to whole chunks or tiles.
int64_t pixels_in_chunks(const Imf::Header& header, int64_t channels, const std::string& name) {
  const auto data = extent(header.dataWindow());
  if (!header.hasTileDescription()) {
    if (data.x * channels * rows_in_chunk(header.compression()) > most_samples_in_a_chunk)
      throw InputError(name, "channels",
                       fmt::format("{} channels of {} x {} pixels, more than fits in memory",
                                   channels, data.x, data.y));
    return data.x * data.y;
  }
  const auto& tile = header.tileDescription();
  const int64_t x = tile.xSize, y = tile.ySize;
  if (x < 1 || y < 1 || x > most_samples_in_a_tile || x * y > most_samples_in_a_tile / channels)
    throw InputError(name, "tiles",
                     fmt::format("tiles of {} x {} pixels, more than fits in memory", x, y));
  return ((data.x + x - 1) / x * x) * ((data.y + y - 1) / y * y);
}

// Memory for the picture and for reading it.
void check_memory(const Imf::Header& header, size_t layers, int64_t bytes_of_pixel,
                  const std::string& name) {
  const auto data = extent(header.dataWindow()), shown = extent(header.displayWindow());
  const auto planes = static_cast<int64_t>(layers);
  const int64_t of_pixel = static_cast<int64_t>(sizeof(Vec3f)) * planes;
  const int64_t picture = shown.x * shown.y * of_pixel;
  const int64_t rows = data.x * std::min<int64_t>(data.y, rows_at_once(header, layers)) * of_pixel;
  const int64_t chunk = data.x * rows_decoded_at_once(header) * bytes_of_pixel;
  expect_memory(name, "display window", words_of(shown, layers),
                static_cast<uint64_t>(picture + rows + 2 * chunk));
}

template <class T>
std::optional<T> number_at(std::string_view bytes, uint64_t at) {
  if (at > bytes.size() || bytes.size() - at < sizeof(T)) return {};
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// These come first in the table.
uint64_t chunks_of_largest_level(const Imf::Header& header) {
  const auto data = extent(header.dataWindow());
  const auto parts = [](int64_t side, int64_t part) {
    return static_cast<uint64_t>((side + part - 1) / part);
  };
  if (!header.hasTileDescription()) return parts(data.y, rows_in_chunk(header.compression()));
  const auto& tile = header.tileDescription();
  return parts(data.x, tile.xSize) * parts(data.y, tile.ySize);
}

}  // namespace

Vec3<int64_t> extent(const Imath::Box2i& box) {
  return {std::max<int64_t>(0, int64_t(box.max.x) - box.min.x + 1),
          std::max<int64_t>(0, int64_t(box.max.y) - box.min.y + 1), 0};
}

int rows_at_once(const Imf::Header& header, size_t layers) {
  constexpr int64_t most = 256, pixels = int64_t(1) << 22;
  const int64_t width = extent(header.dataWindow()).x;
  const int64_t few = pixels / (width * static_cast<int64_t>(std::max<size_t>(1, layers)));
  const int64_t chunk = std::min(most, rows_decoded_at_once(header));
  return static_cast<int>(std::max(chunk, std::min(most, few) / chunk * chunk));
}

void check_size(const Imf::Header& header, size_t layers, std::string_view bytes,
                const std::string& name) {
  check_windows(header, name);
  const auto data = extent(header.dataWindow()), shown = extent(header.displayWindow());
  const ChannelSums channels = channels_of(header);
  const int64_t declared = pixels_in_chunks(header, channels.count, name) * channels.bytes_of_pixel;
  const int64_t held =
      bytes_for_nothing + expansion(header.compression()) * static_cast<int64_t>(bytes.size());
  if (declared > held)
    throw InputError(
        name, "data window",
        fmt::format("{} x {} pixels of {} channels are {}, expected at most {} in a file of {}",
                    data.x, data.y, channels.count, size_words(static_cast<uint64_t>(declared)),
                    size_words(static_cast<uint64_t>(held)), size_words(bytes.size())));
  const int64_t around = pixels_around_nothing + pixels_around_each * data.x * data.y;
  if (shown.x * shown.y * static_cast<int64_t>(layers) > around)
    throw InputError(name, "display window",
                     fmt::format("{} around {} x {} that have data, expected at most {} in all",
                                 words_of(shown, layers), data.x, data.y, around));
  check_memory(header, layers, channels.bytes_of_pixel, name);
}

void check_chunks(Imf::MultiPartInputFile& file, int part, std::string_view bytes,
                  const std::string& name) {
  uint64_t table = headers_of(bytes).end;
  for (int p = 0; p < part; ++p)
    table += 8 * static_cast<uint64_t>(std::max(0, file.header(p).chunkCount()));
  const Imf::Header& header = file.header(part);
  // Prefix of a chunk: part number, in a multi-part file; row, or position and level of the tile;
  // size.
  const uint64_t before =
      (Imf::isMultiPart(file.version()) ? 4u : 0u) + (header.hasTileDescription() ? 16u : 4u);
  const uint64_t chunks = chunks_of_largest_level(header);
  for (uint64_t k = 0; k < chunks; ++k) {
    const uint64_t at = number_at<uint64_t>(bytes, table + 8 * k).value_or(0);
    const auto size = number_at<int32_t>(bytes, at + before);
    if (at == 0 || !size)
      throw InputError(name, "", fmt::format("is damaged: chunk {} of {} is missing", k, chunks));
    if (*size <= 0)
      throw InputError(name, "", fmt::format("is damaged: chunk {} of {} is empty", k, chunks));
  }
}

}  // namespace tdpt::exr

namespace tdpt {

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
    exr::Headers headers = exr::headers_of(bytes);
    if (headers.end > 0) return std::move(headers.strings);
  }
  return {};
}

}  // namespace tdpt
