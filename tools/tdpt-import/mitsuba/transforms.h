// Transforms of Mitsuba scenes.
#pragma once
#include "tools/tdpt-import/mitsuba/object.h"

namespace tdpt::foreign::mitsuba {

/// One step of a transform: translate, rotate, scale, lookat, matrix. Empty: no such step.
std::optional<Affine> step_of(const std::string& tag, const Attributes& attributes,
                              const Place& place);

/// The inverse; `place` is named if there is none.
Affine inverse(const Affine& map, const Place& place);
/// The map without translation, its axes at length 1; fails if one has no length.
Affine axes_of(const Affine& map, const Place& place);

}  // namespace tdpt::foreign::mitsuba
