// Light profiles of luminaires, measured by their makers: IES LM-63 files of 1986 to 2019.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt {

/// Intensity by direction. A row is a polar angle from `pole`; a column is an azimuth about it,
/// from `zero` towards cross(zero, pole). Bilinear in both angles; 0 beyond the last row or column.
struct LightProfile {
  double peak = 0;   ///< largest intensity [cd]
  double reach = 0;  ///< polar angle beyond which it is dark [rad], > 0
  double mean = 0;   ///< mean of intensity / peak over the directions within reach
  /// In the luminaire's frame, which aims along -z. `pole`: the aim, or for goniophotometers of
  /// type B and A the axis that they turn about; `zero`: azimuth 0.
  Vec3d pole{0, 0, -1}, zero{1, 0, 0};
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
