// Two rooms connected by a window, with realistic materials and lights.
#pragma once
#include <string>

namespace tdpt::testing {

/// Contents of the rooms of rooms.h. The camera's room is x 0..2, the lamps are in x 2.1..4.1, the
/// window between them is 1 x 1 m: y 0.5..1.5, z -0.5..0.5.
struct GlossyRooms {
  bool plastic_floor = false;  ///< roughness 0.3 over a diffuse colour, in both rooms
  bool metal_walls = false;    ///< back walls of rough metal (roughness 0.45)
  bool mirror = false;         ///< perfect, on the front wall of the camera's room
  bool glass = false;          ///< a smooth solid slab, smoothly shaded sphere of frosted glass
  bool smooth = false;         ///< smoothly shaded spheres, one of them of shiny plastic
  bool textures = false;       ///< colour, roughness and normals of the block come from pictures
  bool screen = false;         ///< a screen with holes (alpha mask) before the window
  bool veil = false;           ///< a half transparent sheet (alpha blend) before the window
  bool pane = false;           ///< a thin frosted pane before the window
  bool coats = false;  ///< a second block under a smooth clear coat that ignores its normal map; a
                       ///< sphere of rough coat over rough metal; one of cloth

  /// A lamp of 1.6 x 1.6 m below the ceiling, plain or textured; a free-hanging one that emits on
  /// both sides, is also a mirror and half transparent; a point, a spot, a luminaire with an uneven
  /// profile; a sun that shines through an open end of the second room.
  enum class Light {
    lamp,
    textured_lamp,
    mirror_lamp,
    point,
    spot,
    luminaire,
    sun
  } light = Light::lamp;
};

/// A .glb. Everything not asked for is diffuse.
std::string glossy_rooms(const GlossyRooms& what);

}  // namespace tdpt::testing
