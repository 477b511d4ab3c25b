// Builds the bounding volume hierarchy that shaders/shared/traversal.h traverses on CPU and GPU:
// binary, split by the surface area heuristic over bins of all three axes.
#pragma once
#include <vector>

#include "libcommon/scene/scene.h"
#include "shaders/shared/bvh.h"

namespace tdpt {

struct Bvh {
  std::vector<shader::BvhNode> nodes;  ///< depth first; node 0 is the root, also of an empty scene
  std::vector<shader::BvhTriangle> triangles;  ///< every triangle of the scene once
};

/// The result does not depend on the number of threads. Coordinates must be finite; full accuracy
/// is reached within [-1,1] (the canonical frame). Throws Error if the scene has more than 2^28
/// triangles.
Bvh build_bvh(const Scene& scene);

}  // namespace tdpt
