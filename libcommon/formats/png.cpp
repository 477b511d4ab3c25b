#include "libcommon/formats/png.h"

#include <new>
#include <stdexcept>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

namespace tdpt {

std::string png_of_rgb8(int width, int height, const std::vector<uint8_t>& rgb) {
  if (width < 1 || height < 1 ||
      rgb.size() != size_t{3} * static_cast<size_t>(width) * static_cast<size_t>(height))
    throw std::invalid_argument("a PNG needs 3 values a pixel and at least one pixel");
  std::string bytes;
  const auto append = [](void* to, void* data, int n) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<size_t>(n));
  };
  if (!stbi_write_png_to_func(append, &bytes, width, height, 3, rgb.data(), width * 3))
    throw std::bad_alloc();
  return bytes;
}

}  // namespace tdpt
