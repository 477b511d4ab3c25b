// A vertex of a path: a point, and where walks may be directed from it.
//
// A path x_0 ... x_k runs from a light (x_0) to the camera (x_k); k edges = depth k. Sub-paths are
// kept in the order they were walked: y_0 y_1 ... from the light, z_0 z_1 ... from the camera.
#pragma once
#include <array>

#include "tools/tdpt-render/path/point.h"

namespace tdpt {

/// How a walk is directed at the portals where it stands (guide.h).
struct Aim {
  double chance = 0;      ///< that it is
  double per_weight = 0;  ///< chance / W
};

/// Where walks may be directed from a point. All 0 where none is (Guide).
struct Aims {
  Vec3d facing{};                ///< side of the surface that the path's edges are on; 0: both
  std::array<Aim, 2> scattered;  ///< of a walk from the light, from the camera, that scatters here
  Aim emitted;                   ///< of a walk that begins here
};

struct Vertex : Point {
  Aims aims;
};

}  // namespace tdpt
