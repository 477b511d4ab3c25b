// For tests: the two rooms with rectangular lights besides the lamp.
#pragma once
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sheets.h"

namespace tdpt {

/// An emitting rectangle p, p+u, p+u+v, p+v [m], front along cross(u, v).
inline void add_rect_light(Scene& scene, const Vec3d& p, const Vec3d& u, const Vec3d& v,
                           const Rgb& emission, bool both_sides = false) {
  Material shines = scene.materials[0];
  shines.emission = emission;
  shines.double_sided = both_sides;
  scene = with_sheet(scene, shines, p, u, v);
}

/// One in the ceiling, one in a wall near the floor, one in mid air that shines on both sides; four
/// with the lamp.
inline Scene with_rect_lights(Scene scene) {
  add_rect_light(scene, {0.5, 1.95, -0.4}, {0.8, 0, 0}, {0, 0, 0.6}, Rgb(3.0f));
  add_rect_light(scene, {0.05, 0.1, -0.5}, {0, 1.2, 0}, {0, 0, 0.8}, {1, 2, 3});
  add_rect_light(scene, {1.2, 1.0, 0.2}, {0.3, 0.1, 0}, {-0.03, 0.09, 0.25}, Rgb(5.0f), true);
  return scene;
}

}  // namespace tdpt
