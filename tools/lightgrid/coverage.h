// Coverage (alpha) of the surfaces that are not opaque, in the layout of shaders/shared/coverage.h.
#pragma once
#include <vector>

#include "libcommon/scene/scene.h"
#include "shaders/shared/light_layout.h"

namespace tdpt {

struct CoverageTables {
  std::vector<uint32_t> coverage_of;        ///< of each triangle; empty when all are opaque
  std::vector<shader::Coverage> coverages;  ///< of the triangles that are not opaque
  std::vector<float> texels;                ///< alpha in [0,1] of the images that they use
};

/// Of a scene whose glass is open (open_glass()): panes count as opaque.
CoverageTables make_coverages(const Scene& scene);

}  // namespace tdpt
