#include "libcommon/formats/png.h"

#include <algorithm>
#include <cstdlib>
#include <new>
#include <stdexcept>

#include <zlib.h>

// Replaces the header's own compressor, which makes files a third larger. Its result is freed by
// the header.
static unsigned char* png_deflate(unsigned char* data, int size, int* out_size, int) {
  uLongf length = compressBound(static_cast<uLong>(size));
  auto* out = static_cast<unsigned char*>(std::malloc(length));
  if (!out || compress2(out, &length, data, static_cast<uLong>(size), 6) != Z_OK) {
    std::free(out);
    return nullptr;
  }
  *out_size = static_cast<int>(length);
  return out;
}
#define STBIW_ZLIB_COMPRESS png_deflate
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

namespace tdpt {

std::string png_of_rgb8(int width, int height, const std::vector<uint8_t>& values, PngKind kind) {
  const size_t pixels =
      static_cast<size_t>(std::max(width, 0)) * static_cast<size_t>(std::max(height, 0));
  const int channels = values.size() == 4 * pixels ? 4 : 3;
  if (pixels == 0 || values.size() != static_cast<size_t>(channels) * pixels)
    throw std::invalid_argument(
        "a PNG needs a value for each channel of a pixel, and at least one pixel");
  // -1: the best PNG filter for each row; 0: none.
  stbi_write_force_png_filter = kind == PngKind::drawing ? 0 : -1;
  std::string bytes;
  const auto append = [](void* to, void* data, int n) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<size_t>(n));
  };
  if (!stbi_write_png_to_func(append, &bytes, width, height, channels, values.data(),
                              width * channels))
    throw std::bad_alloc();
  return bytes;
}

}  // namespace tdpt
