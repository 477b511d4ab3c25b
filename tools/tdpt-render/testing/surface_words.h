// Test only: shaders/shared/path/surface_test.h as C++.
#pragma once
#include "shaders/shared/path/words_test.h"
#include "tools/tdpt-render/testing/scalar_surfaces.h"

namespace tdpt::shader {

struct SurfaceWords : ScalarSurface {
  using ScalarSurface::ScalarSurface;
#include "shaders/shared/path/surface_test.h"
};

}  // namespace tdpt::shader
