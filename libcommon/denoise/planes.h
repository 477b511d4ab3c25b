// Pictures as planes, one number per pixel, row by row from the top left.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

namespace tdpt::denoise {

struct Size {
  int width = 0, height = 0;
  size_t pixels() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
};

using Plane = std::vector<float>;
using Colour = std::array<Plane, 3>;

/// Gaussian filter of that standard deviation [pixels], cut off at three of them and normalised, at
/// the borders too.
Plane smooth(const Plane& plane, Size size, double deviation);
/// The same of a pixel's neighbours, without itself.
Plane smooth_others(const Plane& plane, Size size, double deviation);

/// Half as wide and high, rounded up: means of 2 x 2 pixels.
inline Size half_of(Size size) {
  return {(size.width + 1) / 2, (size.height + 1) / 2};
}
Plane halved(const Plane& plane, Size size);
/// From half_of(size) back to `size`, by linear interpolation.
Plane doubled(const Plane& plane, Size size);

/// Median of each pixel and those around it, 3 x 3; at the borders of those that there are.
Plane medians(const Plane& plane, Size size);

}  // namespace tdpt::denoise
