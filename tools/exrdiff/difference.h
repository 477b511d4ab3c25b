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

/// The same for the picture on the left and the reference on the right, both toned [tone.h] at one
/// exposure [stops], with a white line between them.
Picture side_by_side(const Picture& picture, const Picture& reference, double exposure);

}  // namespace tdpt
