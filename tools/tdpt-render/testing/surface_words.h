// Test only: shaders/shared/path/surface_test.h as C++.
#pragma once
#include "shaders/shared/path/surface_words.h"
#include "tools/tdpt-render/testing/surface_twin.h"

namespace tdpt::shader {

struct SurfaceWords : SurfaceTwin {
  using SurfaceTwin::SurfaceTwin;
#include "shaders/shared/path/surface_test.h"
};

}  // namespace tdpt::shader
