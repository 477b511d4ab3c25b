// Test only: converts points of the CPU renderer (doubles) to those of kernels (floats).
#pragma once
#include "tools/tdpt-render/path/bsdf/point.h"
#include "tools/tdpt-render/testing/scalar_surfaces.h"

namespace tdpt::test {

/// A scalar build without a scene that supports every feature of a Bsdf.
inline const shader::ScalarSurface& any_surface() {
  static const shader::Curves curves;
  static const shader::ScalarSurface scalar = [] {
    static const SurfaceTables none;
    shader::ScalarSurface t(none, curves);
    t.scene_has_layers = t.scene_has_coats = t.scene_has_sheen = t.scene_has_transmission = true;
    return t;
  }();
  return scalar;
}

inline shader::Point in_floats(const Point& p) {
  shader::Point f{};
  f.position = Vec3f(p.position), f.normal = Vec3f(p.normal), f.shading = Vec3f(p.shading);
  f.simple = p.simple, f.connectible = p.connectible;
  f.bsdf = p.bsdf, f.color = p.color;
  return f;
}

}  // namespace tdpt::test
