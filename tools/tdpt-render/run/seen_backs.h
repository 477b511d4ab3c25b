// How much of the picture shows backs of single-sided surfaces, which glTF viewers do not draw.
#pragma once
#include <string>

#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

struct SeenBacks {
  double share = 0;      ///< of the picture
  std::string material;  ///< whose backs are most of it: material "wall", materials[2]
};

/// By 32 x 32 rays at fixed places of the film.
SeenBacks seen_backs(const World& world);

/// A sentence about a camera that is to see through backs where none is in its way, or nothing.
std::string no_backs_sentence(const World& world);

/// A sentence of warning, or nothing where it is too little to matter.
std::string backs_sentence(const SeenBacks& seen);

}  // namespace tdpt
