// Pictures as planes, one number per pixel, row by row from the top left; their outliers, and the
// light that filtering takes away.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

namespace tdpt::denoise {

struct Size {
  int width = 0, height = 0;
  size_t pixels() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
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

/// Darkens the outliers of two halves and returns their number. Those are pixels that a rare bright
/// path made far brighter than their neighbours, in one half of the samples alone: what is really
/// so bright is bright in both. They get twice the brightness of their surroundings: the second
/// brightest of the half's 5 x 5 pixels around, or the brightest of the other half's 3 x 3.
size_t cut_outliers(Size size, Colour& a, Colour& b);

/// Gives back what the filter and the cut took away from both halves, averaged over the pixels
/// around and in proportion to their light: so brightness stays. What one half alone lacks, as the
/// light of one rare path, is left out: it would be a glow.
void restore_light(Size size, const Colour& a, const Colour& b, float share_a, Colour& picture);

}  // namespace tdpt::denoise
