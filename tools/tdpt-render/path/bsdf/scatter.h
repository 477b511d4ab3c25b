// How light scatters at a point of a path: the next direction of a walk, and what is lost on the
// way [shaders/shared/path/scatter.h].
#pragma once
#include <optional>

#include "tools/tdpt-render/path/bsdf/surfaces.h"

namespace tdpt {

/// A point as it is seen along one direction, where a walk came from or might: what all that it
/// then does has in common.
struct Incidence {
  Incidence() = default;
  Incidence(const Point& p, const Vec3d& from) { become(p, from); }
  /// In place: what the layers are told is large, and a simple point has none.
  void become(const Point& p, const Vec3d& from) {
    back = from;
    if (!p.simple) see_layers(p);
  }

  Vec3d back;                                              ///< unit, away from the surface
  std::optional<shader::Surfaces::ScatterContext> layers;  ///< of a point that is not simple

 private:
  void see_layers(const Point& p);
};

/// Three numbers in [0,1): direction, two, and the choice of a lobe. False when the walk ends here;
/// `out.dirac` then tells whether a Dirac lobe was tried, as bent normals may send what it reflects
/// into the surface.
bool turn(const Point& p, From from, const Incidence& in, const std::array<double, 3>& u,
          Turn& out);
/// The same with the direction given: `out` is by a lobe that is not Dirac.
bool turn_towards(const Point& p, From from, const Incidence& in, const Vec3d& w, Turn& out);

double layered_pdf_w(const Point& p, const Incidence& in, const Vec3d& to, bool dirac);
/// Density [1/sr] of going on along unit `to`. `dirac`: by a Dirac lobe; per n^2 |cos| dw, which
/// reflection and refraction preserve.
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
/// Probability that a walk goes on [roulette.h]: the albedo, largest component, but 0.05 at least,
/// 1 at most; 1 off surfaces. Of a pane, that of the share of rays that find it.
inline double albedo_at(const Point& p, const Incidence& in) {
  return p.simple ? surfaces().simple_albedo(p) : layered_albedo(p, in);
}

/// Of a walk that scatters there.
Odds odds_at(const Point& p, const Incidence& in);

/// Directional albedo, all colours, of a point that is not simple.
Rgb albedo_of(const Point& p, const Incidence& in);

/// Share of light that gets along the inside of an absorbing solid from a to b, d long.
Rgb transmittance(const Point& a, const Point& b, const Vec3d& w, double d);

}  // namespace tdpt
