// Builds the hierarchy that shaders/shared/traversal.h walks, on the CPU and on the GPU: two
// children a node, split where the surface area heuristic over bins of all three axes says.
#pragma once
#include <vector>

#include "libcommon/scene/scene.h"
#include "shaders/shared/bvh.h"

namespace tdpt {

struct Bvh {
  std::vector<shader::BvhNode> nodes;  ///< depth first; node 0 is the root, even of an empty scene
  std::vector<shader::BvhTriangle> triangles;  ///< every triangle of the scene once
};

/// The same bytes for any number of threads. Coordinates are to be finite; any of them work, those
/// within [-1,1] (the canonical frame) with full accuracy. Throws Error when the scene has more
/// than 2^28 triangles.
Bvh build_bvh(const Scene& scene);

/// Whether triangles of this material stop every ray, or only some: alpha, panes (pane.h).
bool stops_every_ray(const Material& material);

}  // namespace tdpt
