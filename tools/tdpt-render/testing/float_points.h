// Test only: points of the renderer that counts in doubles, as kernels see them.
#pragma once
#include "tools/tdpt-render/path/bsdf/point.h"
#include "tools/tdpt-render/testing/surface_twin.h"

namespace tdpt::test {

/// A twin of no scene in particular, which has whatever a Bsdf may have.
inline const shader::SurfaceTwin& any_surface() {
  static const std::vector<float> curves = make_surface_curves();
  static const shader::SurfaceTwin twin = [] {
    static const SurfaceTables none;
    shader::SurfaceTwin t(none, curves);
    t.scene_has_layers = t.scene_has_coats = t.scene_has_sheen = t.scene_has_transmission = true;
    return t;
  }();
  return twin;
}

inline shader::Bsdf in_floats(const Bsdf& b) {
  shader::Bsdf f = any_surface().diffuse_bsdf(b.diffuse);
  f.f0 = b.f0, f.f90 = b.f90, f.through = b.through;
  f.alpha = b.alpha, f.eta = b.eta, f.thin = b.thin;
  f.sheen = b.sheen, f.sheen_alpha = b.sheen_alpha;
  f.coat = {b.coat.strength, b.coat.alpha, b.coat.normal};
  if (b.coat && max_component(b.diffuse) > 0) f.under_coat = any_surface().average_under_coat(f);
  return f;
}

inline shader::Point in_floats(const Point& p) {
  shader::Point f{};
  f.position = Vec3f(p.position), f.normal = Vec3f(p.normal), f.shading = Vec3f(p.shading);
  f.simple = p.simple, f.connectible = p.connectible;
  f.bsdf = in_floats(p.bsdf);
  return f;
}

}  // namespace tdpt::test
