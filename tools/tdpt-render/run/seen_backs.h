// How much of the picture shows the backs of single-sided surfaces, which glTF viewers do not draw.
#pragma once
#include <string>

#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

struct SeenBacks {
  double share = 0;      ///< of the picture
  std::string material;  ///< with the largest share of them: material "wall", materials[2]
};

/// From 32 x 32 rays at fixed places of the film.
SeenBacks seen_backs(const World& world);

/// A note if a camera is set to see through backs but none is in its way; else empty.
std::string no_backs_sentence(const World& world);

/// A warning; empty if the share is negligible.
std::string backs_sentence(const SeenBacks& seen);

}  // namespace tdpt
