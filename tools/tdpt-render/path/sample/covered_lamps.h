// Lamps that coincide with another surface: a light panel modelled in the plane of its ceiling, or
// a mesh that is there twice.
//
// Which of two coincident surfaces a ray hits is decided by rounding. Camera walks would hit such a
// lamp only sometimes, next events would always reach it, and integrators would differ in
// brightness. So the lamp is moved in front of the other surface by a hair; one that emits on both
// sides becomes two single-sided ones, in front of the other surface and behind it.
#pragma once
#include <memory>
#include <string>

#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// Emitting triangles that are covered: a ray to some point on an emitting side hits another
/// triangle there; if that emits too, the later of both counts. Tested with 8 to 256 rays each,
/// which depend on the seed: an overlap that few of them hit may be missed.
std::vector<uint32_t> covered_lamps(const Scene& scene, const Tracer& tracer, uint32_t seed);

struct OpenWorld {
  std::shared_ptr<const World> world;
  size_t uncovered = 0;  ///< triangles of the file that were moved
};
/// The world of the scene, with covered lamps moved along their normals until none is found.
OpenWorld open_world(Scene& scene, bool culls);

/// Reports how many triangles were moved, and how far.
std::string uncovered_sentence(size_t triangles, const Frame& frame);

}  // namespace tdpt
