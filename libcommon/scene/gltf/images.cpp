// The only caller of libwebp, and of stb_image, compiled here: only for the two formats that glTF
// allows, and with zeroed memory. If a damaged JPEG ends early or lacks the scan of a colour, the
// decoder continues with uninitialised memory, which would give another image in each run.
#include <algorithm>
#include <cstdlib>
#include <memory>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_MALLOC(size) std::calloc(size, 1)
#define STBI_REALLOC(pointer, size) std::realloc(pointer, size)
#define STBI_FREE(pointer) std::free(pointer)
#include <stb/stb_image.h>

#include <webp/decode.h>

#include "libcommon/scene/gltf/textures.h"

namespace tdpt::gltf {
namespace {

constexpr std::string_view kPng = "\x89PNG\r\n\x1a\n", kJpeg = "\xff\xd8\xff";

const stbi_uc* data_of(std::string_view bytes) {
  return reinterpret_cast<const stbi_uc*>(bytes.data());
}

// Bytes of a PNG's rows before compression; its header comes first in the file. An interlaced image
// has slightly more.
int64_t bytes_of_rows(std::string_view png, int64_t width, int64_t height) {
  constexpr size_t kDepth = 24, kColour = 25;
  const int bits = png[kDepth];
  const int channels = png[kColour] == 2 ? 3 : png[kColour] == 4 ? 2 : png[kColour] == 6 ? 4 : 1;
  return height * (1 + (width * bits * channels + 7) / 8);
}

// Whether so few bytes can encode so many texels. Deflate expands a byte to 1032 at most, and a
// JPEG uses at least a bit per block of 8 x 8.
bool can_hold(std::string_view bytes, int64_t width, int64_t height) {
  const auto size = static_cast<int64_t>(bytes.size());
  if (bytes.starts_with(kPng)) return bytes_of_rows(bytes, width, height) <= 1032 * size;
  return width * height / 64 <= 8 * size;
}

uint32_t big_endian(std::string_view four) {
  uint32_t value = 0;
  for (const char c : four) value = value << 8 | static_cast<uint8_t>(c);
  return value;
}

// Whether its chunks have their declared lengths: stb_image allocates a chunk before it reads it.
bool chunks_lie_within(std::string_view png) {
  for (size_t at = kPng.size(); png.size() - at >= 8;) {
    const size_t length = big_endian(png.substr(at, 4)), left = png.size() - at - 8;
    if (length > left) return false;
    if (png.substr(at + 4, 4) == "IEND") return true;
    at += 8 + std::min(length + 4, left);  // plus the checksum
  }
  return true;
}

// Each scan of a JPEG visits all blocks, and a hundred bytes suffice for one; encoders write ten or
// so.
bool has_few_scans(std::string_view jpeg) {
  constexpr int kMostScans = 500;
  int scans = 0;
  for (size_t at = 0; (at = jpeg.find("\xff\xda", at)) != jpeg.npos; at += 2) ++scans;
  return scans <= kMostScans;
}

// A uniform image needs no bits for its texels, so the size of a file does not bound its texels: up
// to 4096 x 4096 is always accepted, a larger image in proportion to its bytes.
constexpr int64_t kTexelsAlwaysRead = int64_t{1} << 24, kMostTexelsPerByte = 4096;

bool is_webp(std::string_view bytes) {
  return bytes.size() >= 12 && bytes.starts_with("RIFF") && bytes.substr(8, 4) == "WEBP";
}

bool is_animated_webp(std::string_view bytes) {
  WebPBitstreamFeatures features;
  return is_webp(bytes) &&
         WebPGetFeatures(data_of(bytes), bytes.size(), &features) == VP8_STATUS_OK &&
         features.has_animation;
}

std::optional<int64_t> webp_texels_declared(std::string_view bytes) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(data_of(bytes), bytes.size(), &features) != VP8_STATUS_OK ||
      features.has_animation || features.width < 1 || features.height < 1)
    return {};
  const int64_t texels = int64_t{features.width} * features.height;
  if (texels > std::max(kTexelsAlwaysRead, kMostTexelsPerByte * static_cast<int64_t>(bytes.size())))
    return {};
  return texels;
}

std::optional<Image> decode_webp(std::string_view bytes) {
  Image out;
  if (!WebPGetInfo(data_of(bytes), bytes.size(), &out.width, &out.height)) return {};
  const size_t row = size_t{4} * static_cast<size_t>(out.width);
  out.texels.resize(row * static_cast<size_t>(out.height));
  if (!WebPDecodeRGBAInto(data_of(bytes), bytes.size(), out.texels.data(), out.texels.size(),
                          static_cast<int>(row)))
    return {};
  return out;
}

}  // namespace

std::optional<int64_t> texels_declared(std::string_view bytes) {
  if (is_webp(bytes)) return webp_texels_declared(bytes);
  const bool png =
      bytes.starts_with(kPng) && bytes.size() > 12 && bytes.substr(12).starts_with("IHDR");
  const bool known = png || bytes.starts_with(kJpeg);
  if (!known || bytes.size() > (size_t{1} << 30)) return {};
  if (png && !chunks_lie_within(bytes)) return {};
  if (!png && !has_few_scans(bytes)) return {};
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(data_of(bytes), static_cast<int>(bytes.size()), &width, &height,
                             &channels))
    return {};
  if (width < 1 || height < 1 || !can_hold(bytes, width, height)) return {};
  return int64_t{width} * height;
}

std::optional<Image> decode_image(std::string_view bytes) {
  if (is_webp(bytes)) return decode_webp(bytes);
  Image out;
  int channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> rgba(
      stbi_load_from_memory(data_of(bytes), static_cast<int>(bytes.size()), &out.width, &out.height,
                            &channels, 4),
      stbi_image_free);
  if (!rgba || out.width < 1 || out.height < 1) return {};
  out.texels.assign(rgba.get(), rgba.get() + size_t{4} * static_cast<size_t>(out.width) *
                                                 static_cast<size_t>(out.height));
  return out;
}

std::string fault_of_image(std::string_view bytes) {
  struct Format {
    size_t at;
    std::string_view begins;
    const char* name;
    bool read;
  };
  static constexpr Format kFormats[] = {
      {0, kPng, "a PNG", true},         {0, kJpeg, "a JPEG", true}, {8, "WEBP", "a WebP", true},
      {0, "\xabKTX 20", "KTX2", false}, {0, "DDS ", "DDS", false},  {4, "ftypavif", "AVIF", false},
  };
  if (bytes.empty()) return "empty";
  if (is_animated_webp(bytes)) return "an animated WebP, which is not read";
  for (const Format& f : kFormats)
    if (bytes.size() > f.at && bytes.substr(f.at).starts_with(f.begins))
      return std::string(f.name) + (f.read ? " that cannot be decoded" : ", which is not read");
  return "of a format that is not known";
}

}  // namespace tdpt::gltf
