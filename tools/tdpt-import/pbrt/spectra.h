// Colours and spectra of parameters, as linear Rec.709.
#pragma once
#include <optional>
#include <string>

#include "tools/tdpt-import/pbrt/context.h"
#include "tools/tdpt-import/pbrt/parameters.h"

namespace tdpt::foreign::pbrt {

/// What a spectrum is for. Of a light, pbrt-v4 scales every spectrum but `rgb` to luminance 1.
enum class Use { reflectance, index, light };

/// Of any of pbrt's types for colours; none: there is no such parameter, or not of such a type.
std::optional<Rgb> colour_of(Context& context, const Parameters& list, const std::string& name,
                             Use use);
Rgb colour_of(Context& context, const Parameters& list, const std::string& name, Use use,
              const Rgb& absent);

/// Index of refraction: a number or a spectrum, whose green value is taken.
double index_of(Context& context, const Parameters& list, const std::string& name, double absent);

}  // namespace tdpt::foreign::pbrt
