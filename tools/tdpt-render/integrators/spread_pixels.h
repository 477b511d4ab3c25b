// A few pixels that represent a whole picture.
#pragma once
#include <array>
#include <cstdint>

namespace tdpt {

/// The k-th of a sequence of pixels {x, y} spread evenly over a picture: fractional parts of the
/// multiples of the inverse powers of the plastic number (the R2 sequence).
inline std::array<int, 2> spread_pixel(uint64_t k, int width, int height) {
  // Steps as fractions of 2^64.
  const auto spread = [k](uint64_t step, int size) {
    const uint64_t at = (k + 1) * step;
    return static_cast<int>(static_cast<double>(at >> 11) * 0x1p-53 * size);
  };
  return {spread(0xc13fa9a902a6328fULL, width), spread(0x91e10da5c79e7b1dULL, height)};
}

}  // namespace tdpt
