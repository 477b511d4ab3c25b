// Outliers: pixels that a rare bright path made far brighter than their neighbours, in one half of
// the samples alone. What is really so bright is bright in both halves.
#pragma once
#include "libcommon/denoise/planes.h"

namespace tdpt::denoise {

struct Outliers {
  size_t pixels = 0;
  Colour energy, rest;  ///< what was taken from each pixel, and what is left
};

/// Darkens the outliers of one half to twice the brightness of their surroundings: the second
/// brightest of its 5 x 5 pixels around, or the brightest of the other half's 3 x 3.
Outliers cut_outliers(Size size, const Colour& half, const Colour& other);

/// Adds smoothed energy to a picture, in proportion to its light around: the sum is kept but for
/// what smoothing carries across steps of brightness.
void give_back(Size size, const Colour& energy, Colour& picture);

}  // namespace tdpt::denoise
