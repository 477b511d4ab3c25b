// From a hit or a place on a light to a point of a path: what the surface is made of there.
#pragma once
#include "tools/tdpt-render/path/bsdf/scatter.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// Puts `p` where a ray has hit.
void place_on_surface(const World& world, const Hit& hit, Point& p);

/// Puts `p` where a ray along unit `w` leaves the scene, which must have a sky.
void place_in_sky(const World& world, const Vec3d& w, Point& p);

/// Puts `p` on a light. An emitter that is not opaque shines by its coverage: no ray decides here
/// whether it is there.
void place_on_light(const World& world, const Lights::Point& light, Point& p);

}  // namespace tdpt
