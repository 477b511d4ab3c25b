// Whether all that is said of a scene's surfaces and lights is in range.
#pragma once
#include <string>

#include "libcommon/scene/scene.h"

namespace tdpt::testing {

/// The first promise of scene.h and texture.h that a scene breaks, wherever one looks; "" for a
/// sound one.
std::string fault_of(const Scene& scene);

}  // namespace tdpt::testing
