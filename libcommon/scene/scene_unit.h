// Guesses the unit of a scene from its rooms. glTF is in metres; in a scene of centimetres the
// light of a lamp falls with a distance that is a hundred times too long.
//
// Method: height of a room = from the first surface below a point to the first above it, where the
// point is a camera or a lamp. The median of these heights, in metres, tells the unit: no storey is
// 50 m high, and in each other unit most are near 2.7 m. Without a ceiling, and so for landscapes,
// nothing is told.
#pragma once
#include <optional>

#include "libcommon/scene/scene.h"

namespace tdpt {

struct SceneUnit {
  const char* name;  ///< "centimetres"
  double metres;     ///< one of it
  double height;     ///< of a room, taken as metres
};

/// Nothing for a scene that seems to be in metres, or that does not tell.
std::optional<SceneUnit> unit_of(const Scene& scene);

}  // namespace tdpt
