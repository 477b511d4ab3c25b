// What shines from all around as one colour, in words: "R,G,B" [W/m2/sr].
#pragma once
#include <optional>
#include <string>

#include "libcommon/math/vec.h"

namespace tdpt {

constexpr double kBrightestSky = 1e30, kFaintestSky = 1e-30;  // [W/m2/sr]

/// Whether three numbers are meant, however badly put, and not the name of a file: what has commas
/// and is no path, or is a number.
bool means_colour(const std::string& text);

/// The colour that they are; for what is none, `expected` says what would be.
std::optional<Rgb> parse_colour(const std::string& text, std::string& expected);

}  // namespace tdpt
