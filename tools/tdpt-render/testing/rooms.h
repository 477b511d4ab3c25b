// For tests: the rooms of testdata/scenes, with portals that fit them.
#pragma once
#include <string>

#include "libcommon/formats/portal.h"
#include "libcommon/scene/scene.h"

namespace tdpt {

inline std::string two_rooms_path() {
  return TDPT_TESTDATA "/scenes/two-rooms.glb";
}
inline std::string furnace_path() {
  return TDPT_TESTDATA "/scenes/furnace.glb";
}

/// Rectangle p, p+u, p+u+v, p+v; normal along cross(u, v).
inline Portal rectangle(const Vec3d& p, const Vec3d& u, const Vec3d& v) {
  return {"rectangle", {p, p + u, p + u + v, p + v}, {{0, 1, 2}, {0, 2, 3}}, {}};
}

/// In the middle of the wall of two-rooms; light crosses it to -x.
inline Portal portal_in_the_hole() {
  return rectangle({2.05, 0.875, -0.125}, {0, 0, 0.25}, {0, 0.25, 0});
}

/// The hole's portal, and a tilted one across the camera's room that many paths also cross, some of
/// them twice.
inline std::vector<Portal> two_crossing_portals() {
  return {portal_in_the_hole(), rectangle({1.0, 0.2, -0.9}, {0.3, 0, 1.8}, {0.2, 1.6, 0})};
}

/// The furnace with only its ceiling emitting.
inline Scene below_a_glowing_ceiling() {
  Scene scene = read_gltf(furnace_path());
  Material dark = scene.materials[0];
  dark.emission = {};
  scene.materials.push_back(dark);
  for (Triangle& t : scene.triangles)
    if (scene.frame
            .to_metres(Vec3d(scene.positions[t.vertex[0]] + scene.positions[t.vertex[1]] +
                             scene.positions[t.vertex[2]]) /
                       3)
            .y < 1.99)
      t.material = 1;
  return scene;
}

/// Somewhere in the furnace box.
inline Portal portal_in_the_furnace() {
  return rectangle({0.1, 0.5, -0.6}, {0, 0.1, 1.0}, {0.2, 0.9, 0});
}

}  // namespace tdpt
