// Scattering at a vertex of a path: the next direction of a walk, and the throughput it loses
// [shaders/shared/path/scatter.h].
#pragma once
#include <optional>

#include "tools/tdpt-render/path/bsdf/surfaces.h"

namespace tdpt {

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
bool turn(const Point& p, From from, const Incidence& in, const std::array<double, 3>& u,
          Turn& out);
/// The same for a given direction; `out` uses the lobes that are not Dirac.
bool turn_towards(const Point& p, From from, const Incidence& in, const Vec3d& w, Turn& out);

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
Odds odds_at(const Point& p, const Incidence& in);

/// Directional albedo in RGB of a point that is not simple.
Rgb albedo_of(const Point& p, const Incidence& in);

/// Transmittance of an absorbing solid between a and b, at distance d.
Rgb transmittance(const Point& a, const Point& b, const Vec3d& w, double d);

}  // namespace tdpt
