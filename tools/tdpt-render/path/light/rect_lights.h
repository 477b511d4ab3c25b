// The few big flat emitters that rooms have: windows, rectangular lights, a lamp's face. Next
// events choose among them by what arrives [shaders/shared/path/rect_lights.h].
#pragma once
#include <vector>

#include "libcommon/scene/lights.h"

namespace tdpt {

struct RectLight {
  Vec3d corner, x, y, normal;  ///< x, y: unit, along the edges; normal: unit, front side
  double length_x, length_y, least_height;
  double weight;  ///< of what it sends, per area
  const LightSource* source;
  uint32_t triangle0, triangle1;  ///< above the diagonal (x, then y), below it
  uint32_t corners;  ///< two bits each: which of its corners, counted around from x to y, are b1's,
                     ///< b2's of triangle0, of triangle1
};

inline constexpr size_t kMostRectLights = 8;

/// None, unless all surfaces that emit are rectangles of two triangles, one big one or a few.
std::vector<RectLight> rect_lights_of(const Scene& scene, const Lights& lights);

}  // namespace tdpt
