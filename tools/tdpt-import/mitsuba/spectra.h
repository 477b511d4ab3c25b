// Numbers and colours of Mitsuba scenes as linear Rec.709.
#pragma once
#include "tools/tdpt-import/described.h"
#include "tools/tdpt-import/mitsuba/object.h"

namespace tdpt::foreign::mitsuba {

/// What a colour is of: Mitsuba 3 lets a spectrum of equal energy reflect white light as white and
/// shine yellowish.
enum class Of { surface, light };

bool is_colour(const Value& value);
/// Of a float, rgb, srgb, spectrum or blackbody.
Rgb colour_of(const Value& value, bool old, Of of, Source& source);

float mean(const Rgb& c);
bool is_grey(const Rgb& c);

}  // namespace tdpt::foreign::mitsuba
