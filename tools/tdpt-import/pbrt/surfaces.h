// Materials of pbrt-v3 and pbrt-v4 as surfaces of glTF.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

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

// The materials of the scene: surfaces with the alpha of shapes and the medium inside.

class Painter {
 public:
  size_t add(Surface surface) {
    surfaces_.push_back(std::move(surface));
    return surfaces_.size() - 1;
  }
  const Surface& operator[](size_t i) const { return surfaces_[i]; }

  /// MakeNamedMedium.
  void add_medium(Context& context, const std::string& name, const Parameters& list);

  /// Index into the scene's materials of a surface on a shape with these parameters.
  size_t material(Context& context, const Textures& textures, size_t surface,
                  const Parameters& shape, const std::string& inside, const std::string& outside);

 private:
  std::vector<Surface> surfaces_;
  std::map<std::string, std::optional<Rgb>> absorbing_;  // media: left of white after length 1
  std::map<std::string, size_t> made_;
};

}  // namespace tdpt::foreign::pbrt
