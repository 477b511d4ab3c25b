// Finds rectangular lights among a scene's emitters (windows, ceiling panels, the face of a lamp).
// Next events choose among them by the light that arrives [shaders/shared/path/rect_lights.h].
#pragma once
#include <vector>

#include "libcommon/scene/lights.h"

namespace tdpt {

struct RectLight {
  Vec3d corner, x, y, normal;  ///< x, y: unit, along the edges; normal: unit, front side
  double length_x, length_y, least_height;
  double weight;  ///< selection weight, per area
  const LightSource* source;
  uint32_t triangle0, triangle1;  ///< above the diagonal (x, then y), below it
  uint32_t corners;  ///< two bits each: the corners, counted around from x to y, that are b1's and
                     ///< b2's of triangle0, then of triangle1
};

inline constexpr size_t kMostRectLights = 8;

/// Empty unless all emitting surfaces are rectangles of two triangles: one big one or a few.
std::vector<RectLight> rect_lights_of(const Scene& scene, const LightSelection& selection);

}  // namespace tdpt
