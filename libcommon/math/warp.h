// The warps of shaders/shared/warp.h, in floats and in doubles.
#pragma once
#include "libcommon/math/vec.h"
#include "shaders/shared/warp.h"

namespace tdpt {

using shader::cosine_hemisphere;
using shader::uniform_triangle;

}  // namespace tdpt
