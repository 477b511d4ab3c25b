// Outliers, and the light that filtering takes away. Outliers are pixels that a rare
// bright path made far brighter than their neighbours, in one half of the samples alone. What is
// really so bright is bright in both halves.
#pragma once
#include "libcommon/denoise/planes.h"

namespace tdpt::denoise {

struct Outliers {
  size_t pixels = 0;
  Colour rest;  ///< the half without their excess
};

/// Darkens the outliers of one half to twice the brightness of their surroundings: the second
/// brightest of its 5 x 5 pixels around, or the brightest of the other half's 3 x 3.
Outliers cut_outliers(Size size, const Colour& half, const Colour& other);

/// Adds what the filter and the cut took away, averaged over the pixels around and in proportion to
/// their light: so brightness stays, on average over some pixels.
void restore_energy(Size size, const Colour& noisy, Colour& picture);

}  // namespace tdpt::denoise
