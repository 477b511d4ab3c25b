// Environment maps: the surroundings of a scene as a picture of all directions.
#pragma once
#include <string>
#include <string_view>

#include "libcommon/scene/sky.h"

namespace tdpt {

/// A latitude-longitude map (OpenEXR or Radiance) in memory; `name` is used in messages. It must be
/// about twice as wide as high, at most 8192 x 4096, and not black. Throws InputError.
Sky::Map parse_environment(std::string_view bytes, const std::string& name);

}  // namespace tdpt
