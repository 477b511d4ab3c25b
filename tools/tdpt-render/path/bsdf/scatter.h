// How light scatters at a point of a path: the next direction of a walk, and what is lost on the
// way [shaders/shared/path/scatter.h].
#pragma once
#include "tools/tdpt-render/path/bsdf/point.h"

namespace tdpt {

/// `back`: unit, where the walk came from. `u`: direction, two numbers, and the choice of a lobe.
/// False when the walk ends here; `out.dirac` then tells whether a Dirac lobe was tried, as bent
/// normals may send what it reflects into the surface.
bool turn(const Point& p, From from, const Vec3d& back, const std::array<double, 3>& u, Turn& out);
/// The same with the direction given: `out` is by a lobe that is not Dirac.
bool turn_towards(const Point& p, From from, const Vec3d& back, const Vec3d& w, Turn& out);

/// Of a walk that came from `back` and scatters at a point that is not simple.
Odds odds_of(const Point& p, const Vec3d& back);

/// Directional albedo of a point that is not simple, its clear coat included.
Rgb albedo_of(const Point& p, const Vec3d& back);

/// Share of light that gets along the inside of an absorbing solid from a to b, d long.
Rgb transmittance(const Point& a, const Point& b, const Vec3d& w, double d);

}  // namespace tdpt
