// What rays from the camera tell before and after a picture is rendered.
#pragma once
#include <string>

#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// What a camera is focused on where nobody says it: distance of what stops most of a ray through
/// the middle of the picture, canonical, beyond panes and thin veils. Infinite if nothing does.
double distance_in_the_middle(const World& world, const FilmPlane& film);

// The others from 32 x 32 rays at fixed places of the film.

/// A warning that the camera sees the backs of single-sided surfaces, which glTF viewers do not
/// draw, and most of all of which material; empty if the share is negligible.
std::string backs_sentence(const Vista& vista);
/// A note if a camera is set to see through backs but none is in its way; else empty.
std::string no_backs_sentence(const Vista& vista);

/// Why no sample found light, for a black picture: does the camera see backs alone, as in a wall;
/// does something cut its lens?
std::string why_black(const Vista& vista);

}  // namespace tdpt
