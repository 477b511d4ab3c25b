// Scattering at the vertices of a path: the code of shaders/shared/path in doubles, over the
// renderer's points; the next direction of a walk, and the throughput it loses.
#pragma once
#include <optional>
#include <span>

#include "libcommon/scene/scene.h"
#include "shaders/shared/path/microfacet.h"
#include "shaders/shared/path/surface_layout.h"
#include "shaders/shared/vector.h"
#include "shaders/shared/warp.h"
#include "tools/tdpt-render/path/bsdf/point.h"

namespace tdpt {

// Tables that the surface code reads [shaders/shared/path/surface_layout.h]. They are the same for
// every scene and computed on first use.

/// surface_curves[]; takes about 20 ms.
std::span<const double> surface_curves();
/// sheen_curves[]; takes about 100 ms.
std::span<const double> sheen_curves();

}  // namespace tdpt

namespace tdpt::shader {

struct Surfaces {
  using Real = double;
  using Point = tdpt::Point;
  static constexpr bool scene_has_layers = true, scene_has_textures = true, scene_has_coats = true,
                        scene_has_sheen = true, scene_has_transmission = true,
                        scene_has_absorption = true, scene_has_panes = true;

  double load_surface_curve(uint i) const { return curves_[i]; }
  double load_sheen_curve(uint i) const { return sheen_curves()[i]; }
  bool on_surface(const Point& p) const { return p.on_surface(); }
  bool is_in_sky(const Point& p) const { return p.at_infinity(); }
  bool same_side(const Point& p, const Vec3d& a, const Vec3d& b) const {
    return tdpt::same_side(p, a, b);
  }
  Vec3d absorption_of(const Point& p) const {
    return p.material->solid ? Vec3d(p.material->absorption) : Vec3d();
  }
  double opacity_of(const Point& p, const Vec3d& back) const {
    const Pane pane = p.material ? pane_of(*p.material) : Pane{};
    return pane ? pane.opacity(dot(p.normal, back)) : 1;
  }

#include "shaders/shared/path/layers.h"
  // A separate block of includes: each begins with language.h.

#include "shaders/shared/path/bsdf.h"

#include "shaders/shared/path/scatter.h"

 private:
  const double* curves_ = tdpt::surface_curves().data();
};

}  // namespace tdpt::shader

namespace tdpt {

inline const shader::Surfaces& surfaces() {
  static const shader::Surfaces text;
  return text;
}

/// A point as seen from one direction, that of the vertex before; holds what all later evaluations
/// have in common.
struct Incidence {
  Incidence() = default;
  Incidence(const Point& p, const Vec3d& from) { become(p, from); }
  /// In place, since the layers' context is large and a simple point has none.
  void become(const Point& p, const Vec3d& from) {
    back = from;
    if (!p.simple) see_layers(p);
  }

  Vec3d back;                                              ///< unit, away from the surface
  std::optional<shader::Surfaces::ScatterContext> layers;  ///< null for a simple point

 private:
  void see_layers(const Point& p);
};

/// Samples the next direction. Three numbers in [0,1): two for the direction, one for the choice of
/// a lobe. False if the walk ends here; `out.dirac` then says whether a Dirac lobe was chosen: bent
/// normals may reflect into the surface.
inline bool turn(const Point& p, From from, const Incidence& in, const std::array<double, 3>& u,
                 Turn& out) {
  if (p.simple) return surfaces().simple_turn(p, in.back, u[0], u[1], out);
  const auto end = static_cast<uint32_t>(from);
  return surfaces().layered_turn(p, end, *in.layers, u[0], u[1], u[2], out);
}
/// The same for a given direction; `out` uses the lobes that are not Dirac.
inline bool turn_towards(const Point& p, From from, const Incidence& in, const Vec3d& w,
                         Turn& out) {
  const auto end = static_cast<uint32_t>(from);
  if (!p.simple) return surfaces().layered_turn_towards(p, end, *in.layers, w, out);
  out = {w, Vec3d(p.color), false};
  return same_side(p, in.back, w);
}

double layered_pdf_w(const Point& p, const Incidence& in, const Vec3d& to, bool dirac);
/// Density [1/sr] of continuing along unit `to`. `dirac`: by a Dirac lobe; then per n^2 |cos| dw,
/// which reflection and refraction preserve.
inline double scatter_pdf_w(const Point& p, const Incidence& in, const Vec3d& to, bool dirac) {
  if (!p.simple) return layered_pdf_w(p, in, to, dirac);
  const double cos = dot(p.normal, to);
  return dot(p.normal, in.back) * cos > 0 ? std::abs(cos) * std::numbers::inv_pi : 0;
}
/// pdf_A of reaching `to` along `e`.
inline double scatter_pdf_A(const Point& at, const Incidence& in, const Edge& e, const Point& to,
                            bool dirac) {
  return to_area(scatter_pdf_w(at, in, e.w, dirac), e, to);
}

double layered_albedo(const Point& p, const Incidence& in);
/// Survival probability of a walk [walk.h]: the largest component of the albedo, clamped to
/// [0.05, 1]; 1 off surfaces. For a pane, the albedo for the rays that it stops.
inline double albedo_at(const Point& p, const Incidence& in) {
  return p.simple ? surfaces().simple_albedo(p) : layered_albedo(p, in);
}

/// Lobe probabilities of a walk that scatters there.
inline Odds odds_at(const Point& p, const Incidence& in) {
  return p.simple ? Odds{0, 1} : surfaces().coated_odds(p, *in.layers);
}

/// Directional albedo in RGB of a point that is not simple.
inline Rgb albedo_of(const Point& p, const Incidence& in) {
  return Rgb(surfaces().coated_albedo(p, *in.layers));
}

/// Transmittance of an absorbing solid between a and b, at distance d.
inline Rgb transmittance(const Point& a, const Point& b, const Vec3d& w, double d) {
  return Rgb(surfaces().transmittance(a, b, w, d));
}

}  // namespace tdpt
