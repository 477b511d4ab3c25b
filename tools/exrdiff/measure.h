// Error measures of a picture against its reference.
//
// Symbols: a, r = components of picture and reference (scene-linear), N = 3 * width * height of
// them, m = mean |r| over all of them. The constants below are the usual 0.01 for a reference of
// mean 1; scaling them by m makes every relative measure independent of the unit of light.
#pragma once
#include <optional>
#include <string>

#include "libcommon/cli/cli.h"
#include "libcommon/formats/picture.h"

namespace tdpt {

struct Measures {
  double mse = 0;     ///< (1/N) sum (a-r)^2
  double psnr = 0;    ///< 10 log10(peak^2 / mse) [dB]; infinite when the pictures are equal
  double mape = 0;    ///< (100/N) sum |a-r| / (|r| + 0.01 m) [per cent]
  double relmse = 0;  ///< (1/N) sum (a-r)^2 / (r^2 + 0.01 m^2)
  /// relmse without the thousandth of the pixels (rounded down) that contributes most: a few
  /// fireflies are ignored.
  double relmse_trimmed = 0;
};

struct Comparison {
  Measures picture;
  Measures black;             ///< the same for a picture that is 0 everywhere
  double mean = 0;            ///< (1/N) sum a
  double reference_mean = 0;  ///< (1/N) sum r
  double nonzero = 0;         ///< share of the picture's pixels with a component other than 0
  double peak = 0;            ///< max |r|, the peak of psnr
};

/// 0.01 m, the offset in the denominator of mape.
double relative_offset(const Picture& reference);

/// Throws InputError, with the names given, if sizes differ, a component is not finite (the first
/// such pixel is named, the others are counted), or the reference is all black.
Comparison compare(const Picture& picture, const std::string& picture_name,
                   const Picture& reference, const std::string& reference_name);

// Pictures of the difference between a picture and its reference, which must have the same size.

/// a - r by component: scene-linear, signed.
Picture difference(const Picture& picture, const Picture& reference);

/// Input of png_bytes() for false colours: white where the luminances agree, red where the picture
/// is brighter, blue where it is darker; saturated when the difference is the reference's own
/// luminance L_r (+ 0.01 of the mean of the reference, as in mape).
Picture false_colour(const Picture& picture, const Picture& reference);

/// The same for the picture on the left and the reference on the right, both toned [tone.h] at one
/// exposure [stops], with a white line between them.
Picture side_by_side(const Picture& picture, const Picture& reference, double exposure);

// What exrdiff prints.

/// For people: one measure a line, the black picture's beside it.
std::string report_text(const Comparison& c);
/// One JSON object; tdpt-json(5) lists the keys. An infinite psnr is null. `exposure`: of the
/// pictures side by side, if they are asked for.
std::string report_json(const Comparison& c, std::optional<double> exposure = {});

/// For --explain.
cli::Decisions decisions_of(const Comparison& comparison, const Picture& reference);

}  // namespace tdpt
