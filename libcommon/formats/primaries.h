// Colours by the primaries that a picture file declares, in linear Rec.709.
//
// P_c    CIE XYZ of primary c in {r, g, b} at full strength: s_c (x_c, y_c, 1 - x_c - y_c)
// s_c    such that P_r + P_g + P_b = W, the white of luminance 1
//
// A colour c_r P_r + c_g P_g + c_b P_b keeps its CIE XYZ: it is light, so it is not adapted to the
// white of Rec.709.
#pragma once
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "libcommon/math/vec.h"

namespace tdpt {

/// CIE x and y of red, green, blue and white.
using Primaries = std::array<double, 8>;
inline constexpr Primaries kRec709{0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329};

/// From colours to XYZ. Throws std::invalid_argument if the primaries do not surround the white.
inline Affine to_xyz(const Primaries& p) {
  const auto xyz = [&](size_t c) { return Vec3d(p[c], p[c + 1], 1 - p[c] - p[c + 1]); };
  const Vec3d r = xyz(0), g = xyz(2), b = xyz(4), white = xyz(6) / p[7];
  const double determinant = dot(r, cross(g, b));
  const Vec3d s = Vec3d(dot(white, cross(g, b)), dot(white, cross(b, r)), dot(white, cross(r, g))) /
                  determinant;
  if (!(p[7] > 0 && std::abs(determinant) > 1e-6 && std::min({s.x, s.y, s.z}) > 0 && is_finite(s)))
    throw std::invalid_argument("primaries that do not surround their white");
  return {s.x * r, s.y * g, s.z * b, {}};
}

/// From colours by these primaries to linear Rec.709; nothing if they are the same within rounding.
/// Throws as to_xyz() does.
inline std::optional<Affine> to_rec709(const Primaries& p) {
  constexpr double rounding = 1e-4;
  bool same = true;
  for (size_t i = 0; i < p.size(); ++i) same = same && std::abs(p[i] - kRec709[i]) <= rounding;
  if (same) return {};
  const Affine m = to_xyz(kRec709);
  const auto inverse = [&](const Vec3d& v) {
    return Vec3d(dot(v, cross(m.y, m.z)), dot(v, cross(m.z, m.x)), dot(v, cross(m.x, m.y))) /
           dot(m.x, cross(m.y, m.z));
  };
  const Affine xyz = to_xyz(p);
  return Affine{inverse(xyz.x), inverse(xyz.y), inverse(xyz.z), {}};
}

/// Light and reflectance are not negative: a colour outside the gamut of Rec.709 is clipped to it.
/// What has no luminance stays as it is.
inline Rgb within_gamut(const Rgb& colour) {
  return luminance(colour) > 0 ? max(colour, Rgb(0)) : colour;
}

}  // namespace tdpt
