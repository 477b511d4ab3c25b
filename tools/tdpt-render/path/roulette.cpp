#include "tools/tdpt-render/path/roulette.h"

#include <algorithm>

namespace tdpt {

double albedo_at(const Point& p, const Vec3d& back) {
  if (!p.on_surface()) return 1;
  const Rgb albedo = p.simple ? p.material->base_color
                              : bsdf::albedo(p.bsdf, Onb<double>(p.shading).to_local(back));
  return std::clamp(static_cast<double>(max_component(albedo)), 0.05, 1.0);
}

}  // namespace tdpt
