// How a picture is shown in a PNG: exposed, and with highlights that roll off to white instead of
// being clipped. Each pixel is shown by itself, so pictures with one exposure can be compared.
//
// c  colour, exposed: linear Rec.709
// p  its largest component
//
//   f(p) = p                up to 1/2
//          1 - 1 / (4 p)    above: the slope at 1/2 is the same, and the limit is 1       [eq. 1]
//   w(p) = 1 - 1 / (1 + 0.15 (p - f(p)))                                                  [eq. 2]
//   shown = (1 - w) (f / p) c + w f (1, 1, 1)                                             [eq. 3]
//
// The largest component becomes f(p), and hue is kept; the brighter a colour, the more it fades to
// white, as on film. The form is that of the Khronos PBR Neutral tone mapper, which starts at 0.76
// and so leaves 29 of 256 levels to highlights. This curve leaves them 67.
#pragma once
#include <string>

#include "libcommon/formats/picture.h"

namespace tdpt {

/// [eq. 3]: no component is above 1. Black if one is NaN.
Vec3d toned(const Vec3d& exposed);
/// The same for each pixel of picture * 2^exposure. Where alpha is less than 1, it applies to the
/// colour before coverage.
Picture toned(const Picture& picture, double exposure);
/// PNG of that, as bytes.
std::string preview_bytes(const Picture& picture, double exposure);

inline constexpr double kMostStops = 150;  ///< of an exposure: floats never need more
/// Exposure [stops] at which the mean of [eq. 1] of luminance is 0.18, the grey that cameras expose
/// for; in hundredths, so that it can be printed and given again. Neither black pixels count, nor
/// those more than three stops above the median: windows and lamps of a room. 0 if all are black.
double auto_exposure(const Picture& picture);

}  // namespace tdpt
