#include "libcommon/testing/files/read_png.h"

#include <cstring>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace tdpt::testing {

PngPixels read_png(std::string_view bytes) {
  PngPixels p;
  int channels = 0;
  uint8_t* texels =
      stbi_load_from_memory(reinterpret_cast<const uint8_t*>(bytes.data()),
                            static_cast<int>(bytes.size()), &p.width, &p.height, &channels, 3);
  if (!texels) return {};
  p.rgb.resize(static_cast<size_t>(p.width) * static_cast<size_t>(p.height));
  std::memcpy(p.rgb.data(), texels, 3 * p.rgb.size());
  stbi_image_free(texels);
  return p;
}

}  // namespace tdpt::testing
