// A vertex of a path: a point, and where walks may be directed from it.
//
// A path x_0 ... x_k runs from a light (x_0) to the camera (x_k); k edges = depth k. Sub-paths are
// kept in the order they were walked: y_0 y_1 ... from the light, z_0 z_1 ... from the camera.
#pragma once
#include <array>

#include "tools/tdpt-render/path/bsdf/point.h"

namespace tdpt {

/// Where walks may be directed from a point: W of what they can aim at [portals.h], 0 where that is
/// nothing (Guide).
struct GuideTotals {
  Vec3d facing{};  ///< side of the surface that the path's edges are on; 0: both
  double from_light = 0, from_camera = 0;  ///< of a walk from there that is scattered here
  double emitted = 0;                      ///< of a walk that begins here
  double of(From from) const { return from == From::light ? from_light : from_camera; }
};

/// What next events know of a point [next_event.h].
struct LightContext {
  Vec3d facing{};   ///< side of the surface that light comes to; 0: both
  double seen = 0;  ///< of the sky through the windows: sum S_F [window_sky.h]
  double sent = 0;  ///< by the rectangular lights [rect_lights.h]; less than 0: not yet told
};

struct Vertex : Point {
  GuideTotals guide_totals;
  LightContext light_context;  ///< of those that next events may be made at
};

}  // namespace tdpt
