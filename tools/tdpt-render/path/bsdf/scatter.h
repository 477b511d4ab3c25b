// How light scatters at a point of a path: the next direction of a walk, and what is lost on the
// way.
#pragma once
#include "tools/tdpt-render/path/bsdf/point.h"

namespace tdpt {

/// The next direction of a walk.
struct Turn {
  Vec3d w;     ///< unit
  Rgb weight;  ///< f cos / pdf_w
  bool dirac;
};
/// `back`: unit, where the walk came from. `u`: direction, two numbers, and the choice of a lobe.
/// False when the walk ends here; `out.dirac` then tells whether a Dirac lobe was tried, as bent
/// normals may send what it reflects into the surface.
bool turn(const Point& p, From from, const Vec3d& back, const std::array<double, 3>& u, Turn& out);
/// The same with the direction given: `out` is by a lobe that is not Dirac.
bool turn_towards(const Point& p, From from, const Vec3d& back, const Vec3d& w, Turn& out);

/// Largest share that a lobe of GGX alpha counts as narrow with: aims at portals are not for it.
constexpr float kNarrow = 0.3f;

/// Of a walk that came from `back` and scatters at a point that is not simple.
struct Odds {
  double dirac = 0;  ///< that a Dirac lobe is tried
  double broad = 1;  ///< that a lobe is taken which is not narrow; 1 where some lobe is Dirac
};
Odds odds_of(const Point& p, const Vec3d& back);
Odds odds_of(const Bsdf& b, const Vec3d& from);

/// Directional albedo of a point that is not simple [bsdf.h], its clear coat included.
Rgb albedo_of(const Point& p, const Vec3d& back);

/// Share of light that gets along the inside of an absorbing solid from a to b, d long.
Rgb transmittance(const Point& a, const Point& b, const Vec3d& w, double d);

}  // namespace tdpt
