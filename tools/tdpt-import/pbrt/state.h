// pbrt's graphics state: what AttributeBegin saves and AttributeEnd brings back.
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "libcommon/math/vec.h"
#include "tools/tdpt-import/pbrt/lights.h"
#include "tools/tdpt-import/pbrt/surfaces.h"

namespace tdpt::foreign::pbrt {

struct State {
  Affine to_world{};      ///< current transformation, at the shutter's opening
  bool is_active = true;  ///< transformations apply to the opening
  bool is_reversed = false;
  size_t surface = 0;  ///< current one of Painter
  std::shared_ptr<const AreaLight> area{};
  std::string inside{}, outside{};  ///< media
  /// pbrt-v4's "Attribute" of shape, light, material, medium, texture; shared until one is added.
  std::array<std::shared_ptr<const std::vector<Parameter>>, 5> attributes{};
};

}  // namespace tdpt::foreign::pbrt
