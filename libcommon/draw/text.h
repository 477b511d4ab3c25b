// Lettering in strokes: printable ASCII, everything else as a small box.
#pragma once
#include <string_view>

#include "libcommon/draw/canvas.h"

namespace tdpt::draw {

enum class Align { left, middle, right };

/// `base`: on the base line. `size`: height of a capital letter in pixels.
void text(Canvas& canvas, Point base, std::string_view words, double size, const Ink& c,
          Align align = Align::left, double weight = 1);
/// Width in pixels.
double text_width(std::string_view words, double size);
/// Upwards along the left side of a picture; `base` as in text().
void text_up(Canvas& canvas, Point base, std::string_view words, double size, const Ink& c,
             Align align = Align::left);

}  // namespace tdpt::draw
