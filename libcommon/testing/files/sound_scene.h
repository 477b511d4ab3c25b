// Checks that all values of a scene's surfaces and lights are in range.
#pragma once
#include <string>

#include "libcommon/scene/scene.h"

namespace tdpt::testing {

/// The first invariant of scene.h and texture.h that a scene violates anywhere; "" if none.
std::string fault_of(const Scene& scene);

}  // namespace tdpt::testing
