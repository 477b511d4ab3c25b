// A vertex of a path: a point, with the totals that guiding and next events need there.
//
// A path x_0 ... x_k runs from a light (x_0) to the camera (x_k); k edges = depth k. Sub-paths are
// stored in walking order: y_0 y_1 ... from the light, z_0 z_1 ... from the camera.
#pragma once
#include <array>

#include "tools/tdpt-render/path/bsdf/point.h"

namespace tdpt {

/// Normalisation W of the guiding distribution at a point [portals.h]; 0 if no portal can be aimed
/// at from there (Guide).
struct GuideTotals {
  Vec3d facing{};  ///< normal on the side of the surface that the path's edges are on; 0: both
                   ///< sides
  double from_light = 0, from_camera = 0;  ///< for walks from that end that scatter here
  double emitted = 0;                      ///< for a walk that begins here
  double of(From from) const { return from == From::light ? from_light : from_camera; }
};

/// What next events know about a point [next_event.h].
struct LightContext {
  Vec3d facing{};   ///< normal on the side of the surface that light arrives at; 0: both sides
  double seen = 0;  ///< sum S_F over the windows through which it sees the sky [window_sky.h]
  double sent = 0;  ///< by the rectangular lights [rect_lights.h]; negative: not yet evaluated
};

struct Vertex : Point {
  GuideTotals guide_totals;
  LightContext light_context;  ///< set for vertices at which next events may be made
};

}  // namespace tdpt
