// How surfaces scatter: the text of shaders/shared/path in doubles, over the renderer's points.
// shaders/shared/path/bsdf.h says what the lobes are.
#pragma once
#include "libcommon/math/vec.h"
#include "shaders/shared/path/point.h"

namespace tdpt {

using shader::Bsdf;
using Odds = shader::Odds<double>;
using Turn = shader::Turn<double>;

}  // namespace tdpt
