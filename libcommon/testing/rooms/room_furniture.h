// Furniture for generated rooms: tables, chairs, shelves and boxes, lower than cameras and lamps.
#pragma once
#include "libcommon/testing/rooms/room_site.h"

namespace tdpt::testing {

/// Up to eight pieces on the floor, away from the walls across x and from the openings so far; none
/// if there is no space.
void furnish(Site& site, const Space& space);

}  // namespace tdpt::testing
