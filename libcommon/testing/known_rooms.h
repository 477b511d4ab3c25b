// Generated rooms whose openings are known: hundreds of different ones from a seed.
#pragma once
#include "libcommon/testing/room_plan.h"

namespace tdpt::testing {

enum class RoomKind {
  hole,           ///< square, 0.05 to 0.6 m
  slit,           ///< upright, 0.03 m wide
  floor_door,     ///< a door that reaches the floor, which has a threshold of its own
  through_floor,  ///< the same over one floor polygon through both rooms
  ajar_full,      ///< a leaf from floor to ceiling, open by 5 to 15 degrees: one slit
  ajar,           ///< a leaf lower than the ceiling: the slit beside it and the gap over it
  window,         ///< 0.6 to 1.1 m, over a sill
  two_openings,   ///< in one wall
  holes_in_row,   ///< three rooms, two holes
  doors_in_row,   ///< three rooms, two doors
  closet,         ///< a hole, and a third room behind one of the two, off the light's way
  keyhole,        ///< 0.01 m in a wall 4 m wide
  wide_window,    ///< most of the wall: hardly a bottleneck
  open_room       ///< one room, lamp and camera in it
};
const char* name_of(RoomKind kind);
/// Kinds with openings to be found, then `keyhole`, then those without a bottleneck.
const std::vector<RoomKind>& all_room_kinds();

struct KnownRoom {
  RoomKind kind;
  uint64_t seed;
  RoomPlan plan;
  Writing writing;
  std::vector<KnownAperture> apertures;  ///< of the plan, before the placement; the light's way
  std::string lamp;                      ///< how the lamp shines, a word

  /// Where they lie in the written scene.
  std::vector<KnownAperture> placed_apertures() const;
  std::string file() const;  ///< kind-seed.glb
};

/// The same room for the same arguments: sizes 2 to 4 m, walls 0.01 to 0.3 m thick, lamps that
/// shine down, up, at the wall with the opening, away from it, or several of them; furniture;
/// every way of splitting; in half of the rooms another placement.
KnownRoom known_room(RoomKind kind, uint64_t seed);

}  // namespace tdpt::testing
