// GGX microfacets: distribution, masking-shadowing and sampling of visible normals.
//
// Shading frame, directions unit; w with w.z > 0, h the microfacet's normal with h.z >= 0; a in
// (0,1] is GGX's alpha.
//   D(h)  = a^2 / (pi (a^2 h_z^2 + h_x^2 + h_y^2)^2)
//   G1(w) = 1 / (1 + L(w)),  G2(v, w) = 1 / (1 + L(v) + L(w)),  L = (sqrt(1 + a^2 tan^2) - 1) / 2
//           (Smith, height-correlated: Heitz 2014)
//   D_w(h) = G1(w) max(0, w.h) D(h) / w_z, the density of the normals seen from w [1/sr]
#pragma once
#include <cmath>
#include <numbers>

#include "libcommon/math/vec.h"

namespace tdpt::ggx {

/// D [1/sr]. The sine is taken from x and y, so that it stays exact for small a.
inline double d(const Vec3d& h, double a) {
  const double s = a * a * h.z * h.z + h.x * h.x + h.y * h.y;
  return a * a / (std::numbers::pi * s * s);
}

/// (1 + 2 L(w)) w_z.
inline double stretched(double cos, double a) {
  return std::sqrt(a * a + (1 - a * a) * cos * cos);
}

/// G1(w) / w_z; finite down to w_z = 0.
inline double g1_over_cos(double cos, double a) {
  return 2 / (cos + stretched(cos, a));
}

/// G2(v, w) / (v_z w_z).
inline double g2_over_cos(double cos_v, double cos_w, double a) {
  return 2 / (cos_w * stretched(cos_v, a) + cos_v * stretched(cos_w, a));
}

/// Normal with density D_w(h) from two uniform numbers in [0,1): a point of the spherical cap that
/// a stretched hemisphere shows to w (Dupuy & Benyoub 2023). 0 in a case of probability 0.
inline Vec3d visible_normal(const Vec3d& w, double a, double u, double v) {
  const Vec3d ws = normalize(Vec3d(a * w.x, a * w.y, w.z));
  const double phi = 2 * std::numbers::pi * u;
  const double hz = (1 - v) * (1 + ws.z), z = hz - ws.z;
  const double r = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
  const Vec3d h(a * (r * std::cos(phi) + ws.x), a * (r * std::sin(phi) + ws.y), hz);
  const double l = length(h);
  return l > 0 ? h / l : Vec3d();
}

}  // namespace tdpt::ggx
