// pbrt's lights.
#pragma once
#include <string>

#include "tools/tdpt-import/pbrt/context.h"
#include "tools/tdpt-import/pbrt/parameters.h"

namespace tdpt::foreign::pbrt {

/// Adds a light of "LightSource".
void add_light(Context& context, const std::string& kind, const Parameters& list,
               const Affine& to_world);

/// What "AreaLightSource" says for the shapes that follow.
struct AreaLight {
  Emission emission{};
  double power = 0;  ///< if above 0, radiance is to be multiplied by this / (pi area) of each face
};
AreaLight area_light(Context& context, const std::string& kind, const Parameters& list);

}  // namespace tdpt::foreign::pbrt
