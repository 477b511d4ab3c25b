// Materials of pbrt-v3 and pbrt-v4 as surfaces of glTF.
#pragma once
#include <map>
#include <string>

#include "tools/tdpt-import/pbrt/textures.h"

namespace tdpt::foreign::pbrt {

struct Surface {
  Material material{};
  /// Front and back of its shapes are exchanged: a body whose inside is thinner than its outside.
  bool turned = false;
  Key key{};  ///< taken when a shape shows it
};

using Surfaces = std::map<std::string, Surface>;

/// Reads a material; `named` are those that a mixture may name.
Surface surface_of(Context& context, const Textures& textures, const Surfaces& named,
                   const std::string& kind, const Parameters& list);

}  // namespace tdpt::foreign::pbrt
