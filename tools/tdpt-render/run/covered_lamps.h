// Lamps that lie in another surface: a panel modelled in the plane of its ceiling, a
// mesh that is there twice.
//
// Which of two surfaces in one place a ray meets is decided by its rounding. Walks from the camera
// would meet such a lamp now and then, next events would always reach it, and each integrator would
// show another brightness. So it is brought before the other surface by a hair; one that emits on
// both sides becomes two of one side, before the other surface and behind it.
#pragma once
#include <memory>
#include <string>

#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// Emitting triangles of which a ray to some place of a side that shines finds another triangle
/// there; of two that emit the later one. Told by 8 to 256 rays to each, others for another seed:
/// an overlap that few of them notice may be missed.
std::vector<uint32_t> covered_lamps(const Scene& scene, const Tracer& tracer, uint32_t seed);

struct OpenWorld {
  std::unique_ptr<World> world;
  size_t uncovered = 0;  ///< triangles of the file that were moved
};
/// A world of the scene, whose covered lamps are moved along their normals until none is found.
OpenWorld open_world(Scene& scene, const Camera& camera, int width, int height,
                     const std::vector<Portal>& portals);

/// Says that so many were moved, and how far.
std::string uncovered_sentence(size_t triangles, const Frame& frame);

}  // namespace tdpt
