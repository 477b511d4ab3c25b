// Evaluates surfaces: the code of shaders/shared/path in doubles, over the renderer's points. Slow
// to compile: other files use scatter.h.
#pragma once
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

}  // namespace tdpt
