// Pictures of the difference between a picture and its reference, which must have the same size.
#pragma once
#include "libcommon/formats/picture.h"

namespace tdpt {

/// a - r by component: scene-linear, signed.
Picture difference(const Picture& picture, const Picture& reference);

/// Input of png_bytes() for false colours: white where the luminances agree, red where the picture
/// is brighter, blue where it is darker; saturated when the difference is the reference's own
/// luminance L_r (+ 0.01 of the mean of the reference, as in mape).
Picture false_colour(const Picture& picture, const Picture& reference);

/// The picture on the left, the reference on the right, a white line between them; both multiplied
/// by 2^exposure of the reference, so that white is 1.
Picture side_by_side(const Picture& picture, const Picture& reference);

}  // namespace tdpt
