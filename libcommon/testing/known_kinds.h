// Builders of the kinds of room that are no plain row; for known_rooms.cpp. Each draws its spaces,
// walls, openings, lamps, furniture and camera.
#pragma once
#include "libcommon/testing/room_site.h"

namespace tdpt::testing {

// known_passages.cpp
void arch(Site& site);
void banister(Site& site);
void double_door(Site& site);
void furnished_door(Site& site);
void l_room(Site& site);
void alcove(Site& site);
void shared_edge(Site& site);
void lampshade(Site& site);

// known_windows.cpp
void glazing_bars(Site& site);
void blinds(Site& site);
void curtains(Site& site);
void bay(Site& site);
void windows_in_row(Site& site);
void lamp_outside(Site& site);

}  // namespace tdpt::testing
