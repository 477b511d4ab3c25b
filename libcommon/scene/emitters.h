// All emitting triangles of a scene as one light: chosen in proportion to power.
#pragma once
#include <cmath>
#include <numbers>

#include "libcommon/math/rng.h"
#include "libcommon/math/warp.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

class Emitters {
 public:
  explicit Emitters(const Scene& scene);

  bool empty() const { return triangles_.empty(); }
  /// Emitted power of the whole scene, luminance, in canonical area: sum of pi * Y(Le) * A, counted
  /// on both sides for double-sided emitters.
  double power() const { return power_; }

  struct Sample {
    uint32_t triangle;
    Vec3d position;  ///< canonical
    Vec3d normal;    ///< unit, on the side to leave by: the front, or either (a fair coin)
    double pdf_A;    ///< of the point, per canonical area
  };
  /// A point on an emitter, uniform by power: 4 dimensions of `rng`.
  Sample sample(Rng& rng) const;
  /// Density of `sample` at any point of `triangle`; 0 when it does not emit.
  double pdf_A(uint32_t triangle) const { return pdf_A_[triangle]; }

 private:
  const Scene& scene_;
  std::vector<uint32_t> triangles_;
  AliasTable table_;
  std::vector<float> pdf_A_;  // per scene triangle
  double power_ = 0;
};

/// Density [1/sr] of the direction in which light leaves an emitter, cos-distributed on the side it
/// leaves by: |cos|/pi on the front, half of that on each side when both emit. `cos_front`: signed
/// cosine to the front normal.
inline double emission_pdf_w(const Material& material, double cos_front) {
  if (material.double_sided) return std::abs(cos_front) * (0.5 * std::numbers::inv_pi);
  return std::max(cos_front, 0.0) * std::numbers::inv_pi;
}

/// Radiance leaving `triangle` into direction `w` (unit, away from the surface).
inline Rgb emitted_radiance(const Material& material, const Vec3d& front_normal, const Vec3d& w) {
  return material.double_sided || dot(front_normal, w) > 0 ? material.emission : Rgb{};
}

}  // namespace tdpt
