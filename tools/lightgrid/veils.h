// Surfaces that are there with a probability, in the layout of shaders/shared/veil.h.
#pragma once
#include <vector>

#include "libcommon/scene/scene.h"
#include "shaders/shared/light_layout.h"

namespace tdpt {

struct VeilTables {
  std::vector<uint32_t> veil_of;    ///< of each triangle; empty when all are opaque
  std::vector<shader::Veil> veils;  ///< of the triangles that are not opaque
  std::vector<float> texels;        ///< alpha in [0,1] of the images that veils use
};

/// Of a scene whose glass is open (open_glass()): panes count as opaque.
VeilTables make_veils(const Scene& scene);

}  // namespace tdpt
