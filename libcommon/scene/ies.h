// Light profiles of luminaires, measured by their makers: IES LM-63 files of 1986 to 2019.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tdpt {

inline constexpr double kLeastIntensity = 1e-30, kMostIntensity = 1e30;  // [cd] or [W/sr], of files

/// Intensity by direction, in the luminaire's frame, which aims along -z. A row is a polar angle
/// from -z; a column is an azimuth about it, from x towards y. Bilinear in both angles; 0 beyond
/// the last row or column.
struct LightProfile {
  double peak = 0;   ///< largest intensity [cd]
  double reach = 0;  ///< polar angle beyond which it is dark [rad], > 0
  double mean = 0;   ///< mean of intensity / peak over the directions within reach
  /// Intensity / peak as lamp.h reads it: numbers of rows and columns, angles of rows and of
  /// columns, ascending [turns], and the values column by column, as floats. A single column means
  /// rotational symmetry. For importance sampling of rings between rows there follow, per row, 1 -
  /// cos of its angle and the cumulative probability of the rings before it and, per ring, the
  /// density of its directions [1/sr].
  std::vector<uint32_t> words;
};

/// Parses the text of a file. Tilt, and anything but intensities, is ignored. Throws InputError,
/// which names `file` and, in it, `place` and the line. `peak` is 0 if no light was measured.
LightProfile read_ies(std::string_view text, const std::string& file, const std::string& place);

}  // namespace tdpt
