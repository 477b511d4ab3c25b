// The BSDF at one point by textbook formulas, with a separate function for each quantity: the
// reference for the code of shaders/shared/path, with which it shares only the albedo tables. For
// tests. Directions are unit, in the shading frame [shaders/shared/path/bsdf.h].
#pragma once
#include "tools/tdpt-render/path/bsdf/point.h"

namespace tdpt::oracle {

namespace bsdf {

bool transmits(const Bsdf& b);
bool only_diffuse(const Bsdf& b);
/// Index of refraction on the side of w.
double index(const Bsdf& b, const Vec3d& w);
/// Lobes that are not Dirac [1/sr], and their sampling density.
Vec3d f(const Bsdf& b, const Vec3d& from, const Vec3d& to);
double pdf_w(const Bsdf& b, const Vec3d& from, const Vec3d& to);
/// Directional albedo: the share of the light from `from` that leaves again.
Vec3d albedo(const Bsdf& b, const Vec3d& from);
/// For the Dirac lobe that connects `from` and `to`.
double dirac_probability(const Bsdf& b, const Vec3d& from, const Vec3d& to);
Vec3d dirac_reflectance(const Bsdf& b, const Vec3d& from, const Vec3d& to);
/// Probability of the diffuse lobe or the sheen.
double diffuse_probability(const Bsdf& b, const Vec3d& from);

}  // namespace bsdf

/// In the coat's own frame, on the side of `from`.
namespace coat {

bool smooth(const shader::Coat& c);
/// 1 - E at cosine `mu`, of either sign.
double left_over(const shader::Coat& c, double mu);
double f(const shader::Coat& c, const Vec3d& from, const Vec3d& to);
double pdf_w(const shader::Coat& c, const Vec3d& from, const Vec3d& to);
double reflectance(const shader::Coat& c, double mu);

}  // namespace coat

/// A point with a clear coat: base and coat as two separate surfaces, each with its own normal in
/// world space. Unit directions point away from it.
class CoatedSurface {
 public:
  explicit CoatedSurface(const Point& p);

  /// As for surfaces of oracle.cpp: densities [1/sr], for a Dirac lobe per n^2 |cos| dw; the
  /// radiance BSDF with geometric cosines, for a Dirac lobe without its delta.
  double pdf_w(const Vec3d& back, const Vec3d& to, bool dirac) const;
  Vec3d scattering(const Vec3d& to_light, const Vec3d& to_camera, bool dirac) const;
  double albedo(const Vec3d& back) const;
  double emission_share(const Vec3d& w) const;
  /// Probabilities of a Dirac lobe, and of a lobe that is not narrow.
  void odds(const Vec3d& back, double& dirac, double& broad) const;

 private:
  double take(const Vec3d& back) const;
  bool seen(const Vec3d& a, const Vec3d& b, bool by_coat) const;
  bool mirrored_by_coat(const Vec3d& a, const Vec3d& b) const;

  const Bsdf& bsdf_;
  Vec3d front_, base_, coat_;  // normals
};

}  // namespace tdpt::oracle
