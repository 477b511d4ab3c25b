#include "tools/tdpt-render/path/sample/roulette.h"

#include <algorithm>

#include "libcommon/scene/pane.h"
#include "tools/tdpt-render/path/bsdf/scatter.h"

namespace tdpt {

double layered_albedo(const Point& p, Vec3d back) {
  double albedo = max_component(albedo_of(p, back));
  // Of walks that found the pane [Hit::presence].
  if (const Pane pane = pane_of(*p.material)) albedo /= pane.presence(dot(p.normal, back));
  return std::clamp(albedo, 0.05, 1.0);
}

}  // namespace tdpt
