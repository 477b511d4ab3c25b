#include "tools/tdpt-import/images.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

#include <fmt/format.h>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#define STBI_NO_HDR
#define STBI_MAX_DIMENSIONS 65536
#include <stb/stb_image.h>

#include "libcommon/base/error.h"
#include "libcommon/formats/picture.h"
#include "libcommon/scene/texture.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign {
namespace {

constexpr int kMostTexels = 1 << 26;
constexpr int kMostSide = 16384;

[[noreturn]] void fail(const std::string& name, const std::string& message) {
  throw InputError(name, "", message);
}

Texels of_picture(Picture&& picture) {
  return {picture.width, picture.height, false, std::move(picture.pixels),
          std::move(picture.alpha)};
}

// Portable float maps: "PF" (colour) or "Pf" (grey), width, height, a scale whose sign gives the
// byte order, then rows from the bottom.
Texels decode_pfm(std::string_view bytes, const std::string& name) {
  const bool colour = bytes[1] == 'F';
  std::istringstream header(std::string(bytes.substr(2, 100)));
  double w = 0, h = 0, scale = 0;
  if (!(header >> w >> h >> scale) || header.eof()) fail(name, "the header of the PFM is damaged");
  const size_t at = 2 + static_cast<size_t>(header.tellg()) + 1;
  if (!(w >= 1 && h >= 1 && w <= kMostSide && h <= kMostSide && w * h <= kMostTexels))
    fail(name, fmt::format("is {} x {} texels, expected 1 to {} a side", w, h, kMostSide));
  Texels t{static_cast<int>(w), static_cast<int>(h), false, {}, {}};
  const size_t channels = colour ? 3 : 1, count = static_cast<size_t>(w * h);
  if (at > bytes.size() || (bytes.size() - at) / 4 / channels < count)
    fail(name, "the PFM is cut short");
  const auto value = [&](size_t i) {
    return value_at<float>(bytes.data() + at + 4 * i,
                           scale > 0 ? std::endian::big : std::endian::little);
  };
  for (int y = t.height - 1; y >= 0; --y)
    for (int x = 0; x < t.width; ++x) {
      const size_t i = t.index(x, y) * channels;
      t.rgb.push_back(colour ? Rgb(value(i), value(i + 1), value(i + 2)) : Rgb(value(i)));
    }
  return t;
}

Texels decode_8bit(std::string_view bytes, const std::string& name) {
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(std::min<size_t>(bytes.size(), 0x7fffffff));
  int w = 0, h = 0, channels = 0;
  if (!stbi_info_from_memory(data, size, &w, &h, &channels))
    fail(name,
         "is no picture that can be read (PNG, JPEG, TGA, BMP, PNM, PSD, GIF, HDR, PFM, EXR)");
  if (w < 1 || h < 1 || w > kMostSide || h > kMostSide || int64_t{w} * h > kMostTexels)
    fail(name, fmt::format("is {} x {} texels, expected 1 to {} a side", w, h, kMostSide));
  // stb_image takes what is missing of these for black.
  const auto byte = [&](size_t i) { return i < bytes.size() ? static_cast<uint8_t>(bytes[i]) : 0; };
  const bool pnm = bytes.starts_with("P5") || bytes.starts_with("P6");
  const bool tga = !bytes.starts_with("BM") && (byte(2) == 2 || byte(2) == 3);
  const size_t of_texel = pnm ? (byte(1) == '6' ? 3 : 1) : tga ? (byte(16) + 7) / 8 : 0;
  if (bytes.size() < (tga   ? 18u
                      : pnm ? 9u
                            : 0u) +
                         static_cast<size_t>(w) * static_cast<size_t>(h) * of_texel)
    fail(name, fmt::format("is cut short: {} bytes for {} x {} texels", bytes.size(), w, h));
  const bool with_alpha = channels == 2 || channels == 4;
  const std::unique_ptr<stbi_uc, void (*)(void*)> texels(
      stbi_load_from_memory(data, size, &w, &h, &channels, 4), stbi_image_free);
  if (!texels) fail(name, fmt::format("cannot be decoded: {}", stbi_failure_reason()));
  Texels t{w, h, true, {}, {}};
  const auto count = static_cast<size_t>(w) * static_cast<size_t>(h);
  t.rgb.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const stbi_uc* p = texels.get() + 4 * i;
    t.rgb.emplace_back(p[0] / 255.0f, p[1] / 255.0f, p[2] / 255.0f);
    if (with_alpha) t.alpha.push_back(p[3] / 255.0f);
  }
  return t;
}

uint32_t big_endian(const std::string& s, size_t at, size_t bytes) {
  uint32_t v = 0;
  for (size_t i = 0; i < bytes; ++i) v = v << 8 | static_cast<unsigned char>(s[at + i]);
  return v;
}

// Length, type, data and check of each chunk.
std::string plain_png(const std::string& png) {
  std::string out = png.substr(0, 8);
  for (size_t at = 8; at + 12 <= png.size();) {
    const size_t length = size_t{big_endian(png, at, 4)} + 12;
    if (length > png.size() - at) return png;
    const std::string_view type(png.data() + at + 4, 4);
    for (const char* kept : {"IHDR", "PLTE", "tRNS", "IDAT", "IEND"})
      if (type == kept) out.append(png, at, length);
    at += length;
  }
  return out;
}

// Segments of a marker and a length, up to the start of the scan.
std::string plain_jpeg(const std::string& jpeg) {
  std::string out = jpeg.substr(0, 2);
  size_t at = 2;
  while (at + 4 <= jpeg.size() && jpeg[at] == '\xff' && jpeg[at + 1] != '\xda') {
    const size_t length = size_t{big_endian(jpeg, at + 2, 2)} + 2;
    if (length < 4 || length > jpeg.size() - at) return jpeg;
    std::string segment = jpeg.substr(at, length);
    const char marker = jpeg[at + 1];
    if (marker == '\xe0' && length >= 16 &&
        segment.compare(4, 5, std::string_view("JFIF\0", 5)) == 0)
      segment.replace(11, 5, std::string("\0\0\1\0\1", 5));  // no unit, 1 : 1
    if (marker != '\xe2') out += segment;                    // profiles are in APP2
    at += length;
  }
  return out.append(jpeg, at, std::string::npos);
}

}  // namespace

Rgb linear_of(const Rgb& coded) {
  const LinearTable& table = linear_of_srgb();
  const auto one = [&](float v) {
    return table[static_cast<size_t>(std::lround(255 * std::clamp(v, 0.0f, 1.0f)))];
  };
  return {one(coded.x), one(coded.y), one(coded.z)};
}

std::string plain_file(const std::string& bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return plain_png(bytes);
  return bytes.starts_with("\xff\xd8") ? plain_jpeg(bytes) : bytes;
}

Texels decode(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) fail(name, "is empty, expected a picture");
  if (bytes.size() < 4) fail(name, "is no picture");
  if (bytes.substr(0, 4) == std::string_view("\x76\x2f\x31\x01", 4))
    return of_picture(parse_exr_picture(bytes, name, kMostSide, kMostSide));
  if (is_radiance_hdr(bytes))
    return of_picture(parse_radiance_hdr(bytes, name, kMostSide, kMostSide));
  if (bytes[0] == 'P' && (bytes[1] == 'F' || bytes[1] == 'f')) return decode_pfm(bytes, name);
  return decode_8bit(bytes, name);
}

Texels decode(const Image& image, const Source& source) {
  if (image.texels.empty()) return decode(image.bytes, source.shown_name(image.name));
  return {image.width, image.height, false, image.texels, {}};
}

}  // namespace tdpt::foreign
