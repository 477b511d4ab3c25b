// Generated rooms with known openings: hundreds of different ones from a seed.
#pragma once
#include "libcommon/testing/rooms/room_plan.h"

namespace tdpt::testing {

enum class RoomKind {
  hole,            ///< square, 0.05 to 0.6 m
  slit,            ///< upright, 0.03 m wide
  floor_door,      ///< a door down to the floor, with a separate threshold
  through_floor,   ///< the same, but one floor polygon spans both rooms
  ajar_full,       ///< a leaf from floor to ceiling, open by 5 to 15 degrees: one slit
  ajar,            ///< a leaf lower than the ceiling: the slit beside it and the gap above it
  window,          ///< 0.6 to 1.1 m, above a sill
  two_openings,    ///< in one wall
  holes_in_row,    ///< three rooms, two holes
  doors_in_row,    ///< three rooms, two doors
  closet,          ///< a hole, and a third room behind one of the two, not on the light's way
  keyhole,         ///< 0.01 m in a wall 4 m wide
  wide_window,     ///< most of the wall: hardly a bottleneck
  open_room,       ///< one room with lamp and camera
  arch,            ///< 3 to 9 m2 with a round top, between a hall and a stairwell
  banister,        ///< a stairwell, open above a parapet or a balustrade up to the ceiling
  glazing_bars,    ///< a window in 2 x 2 to 3 x 4 panes
  blinds,          ///< a window behind 8 to 40 tilted slats
  curtains,        ///< a window or a door, half closed by thin sheets just before the wall
  bay,             ///< three windows at angles
  windows_in_row,  ///< three to eight in one or two walls, with lamps along a corridor outside
  double_door,     ///< both leaves open, or one
  furnished_door,  ///< a piece of furniture in the doorway
  l_room,          ///< an L-shaped room behind a door
  alcove,          ///< a door, and the lamp in an alcove of the room behind it
  shared_edge,     ///< a door and a transom window above it
  lampshade,       ///< one room; the lamp in a box of 0.2 to 0.6 m with one open side
  lamp_outside,    ///< one room; the lamp directly behind its window, with no surface between

  // Lit by a sky, the sun or both through their windows:
  sky_window,      ///< one window
  sky_windows,     ///< two to five, in up to three walls
  corner_windows,  ///< two that almost meet in a corner
  skylight,        ///< one or two in the roof
  sky_blinds,      ///< a window whose blind is half let down
  colonnade,       ///< a hall with three to five openings side by side, down to the floor
  room_behind,     ///< a room behind a door; the windows are in the other room
  deep_facade,     ///< thick walls, a balcony above the windows
  landscape,       ///< no room at all
  deep_room        ///< 2 to 2.5 times as deep as wide, its end wall missing
};
const char* name_of(RoomKind kind);
const std::vector<RoomKind>& all_room_kinds();  ///< lit by lamps, in this order
const std::vector<RoomKind>& sky_room_kinds();  ///< the others

struct KnownRoom {
  RoomKind kind;
  uint64_t seed;
  RoomPlan plan;
  Writing writing;
  std::vector<KnownAperture> apertures;  ///< before the placement; in the light's direction
  std::string lamp;                      ///< one word: how the lamp shines, or what shines
  std::string sky;                       ///< options for the programs that need the light

  /// Their positions in the written scene.
  std::vector<KnownAperture> placed_apertures() const;
  std::string file() const;  ///< kind-seed.glb
};

/// The same arguments give the same room: sizes 2 to 4 m (halls up to 8), walls 0.01 to 0.3 m
/// thick, lamps that shine down, up, at the wall with the opening, away from it, or several of
/// them; furniture; every tessellation; in half of the rooms a random placement.
KnownRoom known_room(RoomKind kind, uint64_t seed);

}  // namespace tdpt::testing
