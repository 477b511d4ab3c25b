// What a camera is focused on where nobody says it.
#pragma once
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// Distance of what stops most of a ray through the middle of the picture, canonical: beyond panes
/// and thin veils. Infinite if nothing does.
double distance_in_the_middle(const World& world, const FilmPlane& film);

}  // namespace tdpt
