// How much of the picture shows backs of surfaces: of single-sided ones, which glTF viewers do not
// draw, or of all that the camera sees.
#pragma once
#include <string>

#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

// All from 32 x 32 rays at fixed places of the film.

/// A note if a camera is set to see through backs but none is in its way; else empty.
std::string no_backs_sentence(const Vista& vista);

/// A warning that the camera sees the backs of single-sided surfaces, most of all of one material;
/// empty if the share is negligible.
std::string backs_sentence(const Vista& vista);

/// Whether each ray meets the back of a surface, as in a wall.
bool sees_only_backs(const Vista& vista);

}  // namespace tdpt
