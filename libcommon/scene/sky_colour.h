// Parses a uniform sky, "R,G,B" [W/m2/sr].
#pragma once
#include <optional>
#include <string>

#include "libcommon/math/vec.h"

namespace tdpt {

constexpr double kBrightestSky = 1e30, kFaintestSky = 1e-30;  // [W/m2/sr]

/// Whether the text is meant as a colour, even a malformed one, and not as a file name: it has
/// commas and is no path, or it is a number.
bool means_colour(const std::string& text);

/// The colour; if it is malformed, `expected` says what is expected.
std::optional<Rgb> parse_colour(const std::string& text, std::string& expected);

}  // namespace tdpt
