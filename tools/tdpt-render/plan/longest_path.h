// The longest path that can bring light to this picture: longer ones are not sampled.
#pragma once
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// False only if the camera's view pyramid misses the whole scene.
bool may_see_surfaces(const Vista& vista);

/// In edges. 0: the picture is black, for want of light or of anything to see; 1: it shows only the
/// sky, or `alpha` of a dark scene is asked for; otherwise `max_depth`.
int longest_path(const Vista& vista, int max_depth, bool alpha);

}  // namespace tdpt
