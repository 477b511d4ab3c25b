// All lights of a scene as one: emitting triangles and punctual lights, chosen in proportion to
// power by an alias table, so that thousands cost a sample no more than one.
#pragma once
#include <cmath>
#include <numbers>

#include "libcommon/math/rng.h"
#include "libcommon/math/warp.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

/// A punctual light with what its samplers need.
struct Lamp {
  PunctualLight light;
  /// Density of what a walk from it draws: a direction, uniform over the sphere or the spot's cone
  /// [1/sr]; directional: a place, uniform over a disc across the scene [1/canonical area].
  double pdf = 0;
  double pdf_1 = 0;  ///< of choosing it

  bool directional() const { return light.kind == PunctualLight::Kind::directional; }
  /// Radiant intensity along unit w [W/sr, canonical area]; directional: irradiance across w.
  Rgb intensity(const Vec3d& w) const;
  /// `pdf` where light leaves along w, else 0.
  double pdf_towards(const Vec3d& w) const;
};

class Lights {
 public:
  explicit Lights(const Scene& scene);

  bool empty() const { return table_.empty(); }
  /// Emitted power of the whole scene, luminance, in canonical area: sum of pi * Y(Le) * A over
  /// emitting sides; of directional lights what passes the disc.
  double power() const { return power_; }

  /// A place light leaves from.
  struct Point {
    const Lamp* lamp = nullptr;  ///< set for punctual lights; then no triangle
    uint32_t triangle = ~0u;
    double b1 = 0, b2 = 0;  ///< barycentrics on the triangle
    Vec3d position{};       ///< canonical; directional lights have none
    Vec3d normal{};         ///< unit, on the side to leave by: the front, or either (a fair coin)
    double pdf = 0;         ///< pdf_A per canonical area; of a lamp: pdf_1
  };
  /// Four numbers in [0,1): which light, where on it (u, v), and which of its sides.
  Point sample(double pick, double u, double v, double side) const;
  /// Draws them from `rng` in this order.
  Point sample(Rng& rng) const;
  /// Density of `sample` at any point of `triangle`; 0 when it does not emit.
  double pdf_A(uint32_t triangle) const { return pdf_A_[triangle]; }

  struct Ray {
    Vec3d origin, direction;
  };
  /// A ray of light from `point`: cos-distributed on a surface, uniform within a lamp's cone, on a
  /// disc outside the scene for directional lights. u, v uniform in [0,1).
  Ray leave(const Point& point, double u, double v) const;

 private:
  const Scene& scene_;
  // Entries of the table: emitting triangles, then the lamps.
  std::vector<uint32_t> triangles_;
  std::vector<TriangleShape> shapes_;
  std::vector<Lamp> lamps_;
  AliasTable table_;
  std::vector<float> pdf_A_;  // per scene triangle
  double power_ = 0;
  double radius_ = 0;  // of a ball around the origin that holds all triangles
};

/// Density [1/sr] of the direction in which light leaves an emitter, cos-distributed on the side it
/// leaves by: |cos|/pi on the front, half of that on each side when both emit. `cos_front`: signed
/// cosine to the front normal.
inline double emission_pdf_w(const Material& material, double cos_front) {
  if (material.double_sided) return std::abs(cos_front) * (0.5 * std::numbers::inv_pi);
  return std::max(cos_front, 0.0) * std::numbers::inv_pi;
}

/// Radiance leaving a surface of `emission` into direction `w` (unit, away from the surface).
inline Rgb emitted_radiance(const Material& material, const Rgb& emission,
                            const Vec3d& front_normal, const Vec3d& w) {
  return material.double_sided || dot(front_normal, w) > 0 ? emission : Rgb{};
}

}  // namespace tdpt
