// Mitsuba's emitters that are no shapes.
#pragma once
#include "tools/tdpt-import/mitsuba/textures.h"

namespace tdpt::foreign::mitsuba {

void add_light(const Object& emitter, Described& scene, Source& source, Textures& textures);

}  // namespace tdpt::foreign::mitsuba
