// The slow, obvious reference for shaders/shared/path/scatter.h: base and coat as two separate
// surfaces, each with its own normal in world space. For tests.
#pragma once
#include "tools/tdpt-render/path/bsdf/point.h"

namespace tdpt::oracle {

/// A point with a clear coat; unit directions point away from it.
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
