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

/// Gives back what the filter and the cut took away from both halves, averaged over the pixels
/// around and in proportion to their light: so brightness stays. What one half alone lacks, as the
/// light of one rare path, is left out: it would be a glow.
void restore_light(Size size, const Colour& a, const Colour& b, float share_a, Colour& picture);

}  // namespace tdpt::denoise
