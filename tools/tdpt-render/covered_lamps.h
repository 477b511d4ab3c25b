// Lamps that lie in another surface: a panel modelled in the plane of its ceiling, a mesh that is
// there twice.
//
// Which of two surfaces in one place a ray meets is decided by its rounding. Walks from the camera
// would meet such a lamp now and then, next events would always reach it, and each integrator would
// show another brightness. So it is brought before the other surface by a hair.
#pragma once
#include <memory>
#include <string>

#include "tools/tdpt-render/path/world.h"

namespace tdpt {

/// Emitting triangles of which a ray to some place of their front finds another triangle there; of
/// two that emit the later one. Told by 1 to 256 rays to each: an overlap that few of them
/// notice may be missed.
std::vector<uint32_t> covered_lamps(const Scene& scene, const Tracer& tracer);

struct OpenWorld {
  std::unique_ptr<World> world;
  size_t uncovered = 0;  ///< triangles that were moved
};
/// A world of the scene, whose covered lamps are moved along their normals.
OpenWorld open_world(Scene& scene, const Camera& camera, int width, int height,
                     const std::vector<Portal>& portals);

/// Says that so many were moved, and how far.
std::string uncovered_sentence(size_t triangles, const Frame& frame);

}  // namespace tdpt
