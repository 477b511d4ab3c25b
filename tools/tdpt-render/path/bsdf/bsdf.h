// The BSDF code of shaders/shared/path in doubles, over the renderer's points.
// shaders/shared/path/bsdf.h describes the lobes.
#pragma once
#include "libcommon/math/vec.h"
#include "shaders/shared/path/point.h"

namespace tdpt {

using shader::Bsdf;
using Odds = shader::Odds<double>;
using Turn = shader::Turn<double>;

}  // namespace tdpt
