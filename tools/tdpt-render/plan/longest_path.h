// How long a path must be at most to bring light to this picture: nothing is sampled beyond.
#pragma once
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// Whether some surface may lie in the camera's view: false only where its pyramid passes the whole
/// scene by.
bool may_see_surfaces(const World& world);

/// In edges. 0: the picture is black, without light or without anything to see; 1: it shows the sky
/// alone, or `alpha` of a dark scene is asked for; else `max_depth`.
int longest_path(const World& world, int max_depth, bool alpha);

}  // namespace tdpt
