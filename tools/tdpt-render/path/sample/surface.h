// Turns a hit, or a place on a light, into a point of a path with its material.
#pragma once
#include "tools/tdpt-render/path/bsdf/scatter.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// Sets `p` to the place where a ray has hit.
void place_on_surface(const World& world, const Hit& hit, Point& p);

/// Sets `p` to the sky, where a ray along unit `w` leaves the scene, which must have a sky.
void place_in_sky(const LightSelection& selection, const Vec3d& w, Point& p);

/// Sets `p` to a place on a light. An emitter that is not opaque shines in proportion to its
/// coverage, since no ray decides here whether it is hit.
void place_on_light(const World& world, const Lights::Point& light, Point& p);

}  // namespace tdpt
