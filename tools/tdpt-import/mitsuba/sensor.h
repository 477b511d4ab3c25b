// Mitsuba's sensors as cameras.
#pragma once
#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/mitsuba/object.h"

namespace tdpt::foreign::mitsuba {

void add_camera(const Object& sensor, Described& scene, Source& source);

}  // namespace tdpt::foreign::mitsuba
