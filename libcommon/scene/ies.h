// How luminaires shine, measured by their makers: IES LM-63 files of 1986 to 2019.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tdpt {

/// Intensity by direction. The vertical angle is that against the luminaire's aim; the horizontal
/// one counts from an axis across it, x, towards y = cross(x, aim). Between the angles of the file
/// intensity is linear in both, beyond the last vertical angle it is 0.
struct LightProfile {
  double peak = 0;   ///< the greatest intensity [cd]
  double reach = 0;  ///< vertical angle beyond which it is dark [rad], > 0
  double mean = 0;   ///< over the directions within reach, of intensity / peak
  /// Intensity / peak as lamp.h reads it: how many rows and columns, the rows' vertical angles, the
  /// columns' horizontal ones, ascending [turns], and values column by column, as floats. One
  /// column, or the last is the first again, a turn later. Then what walks that leave are drawn by,
  /// in rings from one row to the next: of each row 1 - cos of its angle and the probability of the
  /// rings before it, and of each ring the density of its directions [1/sr].
  std::vector<uint32_t> words;
};

/// Reads the text of a file: goniophotometers of type C, and A and B, which are brought to rows and
/// columns of C at most a degree apart. Tilts and what is known besides intensities is passed over.
/// Throws InputError, which names `file` and, in it, `place` and the line. `peak` is 0 where no
/// light is measured.
LightProfile read_ies(std::string_view text, const std::string& file, const std::string& place);

}  // namespace tdpt
