// pbrt's cameras and films.
#pragma once
#include <string>

#include "tools/tdpt-import/pbrt/context.h"
#include "tools/tdpt-import/pbrt/parameters.h"

namespace tdpt::foreign::pbrt {

/// Adds the camera to the scene, or names it as lost. `from_world`: the transformation at the
/// directive "Camera".
void add_camera(Context& context, const std::string& kind, const Parameters& camera,
                const Affine& from_world, const std::string& film_kind, const Parameters& film);

}  // namespace tdpt::foreign::pbrt
