// Pictures that show where a picture differs from its reference. Both must have one size.
#pragma once
#include "libcommon/formats/picture.h"

namespace tdpt {

/// a - r, component by component: scene-linear, with sign.
Picture difference(const Picture& picture, const Picture& reference);

/// What png_bytes() turns into false colour: white where the luminances agree, red where the
/// picture is brighter, blue where it is darker, full at the reference's own luminance L_r (+ 0.01
/// of the mean of the reference, as in mape).
Picture false_colour(const Picture& picture, const Picture& reference);

/// The picture on the left, the reference on the right, a white line between them; both multiplied
/// with 2^exposure of the reference, so that white is 1.
Picture side_by_side(const Picture& picture, const Picture& reference);

}  // namespace tdpt
