// A surface under a clear coat as one: both scatter, each about its own normal.
//
// The coat's normal is not bent by what bends the surface under it, or by a map of its own; light
// above the one normal may be below the other, and then only one of them scatters it. The coat is
// taken with a probability that depends on `back` alone.
#pragma once
#include "tools/tdpt-render/path/bsdf/point.h"
#include "tools/tdpt-render/path/bsdf/scatter.h"

namespace tdpt::coated {

/// As layered_bsdf(), layered_scatter_pdf_w(), turn() and turn_towards(), of points with a coat.
Rgb bsdf(const Point& p, const Vec3d& to_light, const Vec3d& to_camera);
double scatter_pdf_w(const Point& at, const Vec3d& back, const Vec3d& to, bool dirac);
bool turn(const Point& p, From from, const Vec3d& back, const std::array<double, 3>& u, Turn& out);
bool turn_towards(const Point& p, From from, const Vec3d& back, const Vec3d& w, Turn& out);

/// A Dirac lobe that leads from `back` to `to`.
struct Dirac {
  double probability = 0;           ///< that it is taken
  Rgb reflectance{};                ///< or transmittance, of basic radiance
  double cos_back = 0, cos_to = 0;  ///< to the normal it is reflected about
  double n_back = 1, n_to = 1;      ///< index of refraction on the two sides
};
Dirac dirac(const Point& p, const Vec3d& back, const Vec3d& to);

Rgb albedo(const Point& p, const Vec3d& back);
Odds odds(const Point& p, const Vec3d& back);

/// What the coat lets through of light that the surface under it emits along unit w.
double of_emission(const Point& p, const Vec3d& w);

}  // namespace tdpt::coated
