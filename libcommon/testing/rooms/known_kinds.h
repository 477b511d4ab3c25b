// Builders of the rooms that are no plain row; for known_rooms.cpp. Each generates its spaces,
// walls, openings, lamps, furniture and camera.
#pragma once
#include "libcommon/testing/rooms/plan_walls.h"
#include "libcommon/testing/rooms/room_site.h"

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
/// Slats across the whole window in a wall across x, tilted about z, from the bottom upwards, with
/// their middles at `x`, extending `beyond` its edges.
std::vector<Quad> slats(const Wall& wall, const WallOpening& window, int n, double wide,
                        double tilt, double x, double beyond);

// known_skies.cpp
void sky_window(Site& site);
void sky_windows(Site& site);
void corner_windows(Site& site);
void skylight(Site& site);
void sky_blinds(Site& site);
void colonnade(Site& site);
void room_behind(Site& site);
void deep_facade(Site& site);
void landscape(Site& site);
void deep_room(Site& site);

}  // namespace tdpt::testing
