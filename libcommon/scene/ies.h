// How luminaires shine, measured by their makers: IES LM-63 files of 1986 to 2019.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libcommon/math/vec.h"

namespace tdpt {

/// Intensity by direction: the row's angle is that against a pole, the column's counts about it
/// from an axis across it towards cross(zero, pole). Between them intensity is linear in both;
/// beyond the last of either it is 0.
struct LightProfile {
  double peak = 0;   ///< the greatest intensity [cd]
  double reach = 0;  ///< angle against the pole beyond which it is dark [rad], > 0
  double mean = 0;   ///< over the directions within reach, of intensity / peak
  /// In the frame of the luminaire, which aims along -z: the aim, of goniophotometers of type B and
  /// A the axis that they turn about, and where the columns' angles are 0.
  Vec3d pole{0, 0, -1}, zero{1, 0, 0};
  /// Intensity / peak as lamp.h reads it: how many rows and columns, the rows' angles and the
  /// columns', ascending [turns], and values column by column, as floats. One column stands for all
  /// around. Walks leave by rings, from one row to the next: behind the values follow of each row
  /// 1 - cos of its angle, of each the probability of the rings before it, and of each ring the
  /// density of its directions [1/sr].
  std::vector<uint32_t> words;
};

/// Reads the text of a file. Tilts, and what is known besides intensities, are passed over.
/// Throws InputError, which names `file` and, in it, `place` and the line. `peak` is 0 where no
/// light is measured.
LightProfile read_ies(std::string_view text, const std::string& file, const std::string& place);

}  // namespace tdpt
