// Decodes a PNG in memory.
#pragma once
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace tdpt::testing {

struct PngPixels {
  int width = 0, height = 0;  ///< 0: not a PNG
  std::vector<std::array<uint8_t, 3>> rgb;
  const std::array<uint8_t, 3>& at(int x, int y) const {
    return rgb[static_cast<size_t>(x) + static_cast<size_t>(width) * static_cast<size_t>(y)];
  }
};
PngPixels read_png(std::string_view bytes);

}  // namespace tdpt::testing
