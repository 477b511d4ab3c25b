// For tests: the rooms of testdata/scenes with surfaces and lamps of all kinds, and portals that
// fit them.
#pragma once
#include <string>

#include "libcommon/formats/portal.h"
#include "libcommon/math/rng.h"
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

inline Scene diffuse_rooms() {
  return read_gltf(two_rooms_path());
}

/// The same rooms: materials vary by triangle, with bent normals, and there are lamps of each kind
/// besides the emitter, which shines on both sides and reflects as a mirror.
inline Scene glossy_rooms() {
  Scene scene = read_gltf(two_rooms_path());
  std::vector<Material> makes(8);
  for (Material& m : makes) m.plain = false;
  makes[0].plain = true;
  makes[1].specular = 1, makes[1].roughness = 0.5f;  // rough plastic
  makes[2].specular = 1, makes[2].roughness = 0;     // smooth plastic
  makes[3].metallic = 1, makes[3].roughness = 0.4f;  // rough metal
  makes[4].metallic = 1, makes[4].roughness = 0;     // mirror
  makes[5].transmission = 1, makes[5].solid = true, makes[5].specular = 1, makes[5].roughness = 0;
  makes[6] = makes[5], makes[6].roughness = 0.4f;                                  // rough glass
  makes[7].transmission = 0.5f, makes[7].specular = 1, makes[7].roughness = 0.3f;  // thin sheet
  const auto first = static_cast<uint32_t>(scene.materials.size());
  scene.materials.insert(scene.materials.end(), makes.begin(), makes.end());
  scene.smooth.assign(scene.triangles.size(), 1);
  scene.normals.resize(scene.positions.size());
  for (uint32_t t = 0; t < scene.triangles.size(); ++t) {
    Triangle& triangle = scene.triangles[t];
    if (Material& m = scene.materials[triangle.material]; max_component(m.emission) > 0) {
      m.plain = false;
      m.double_sided = true;
      m.base_color = Rgb(0.3f), m.metallic = 1, m.roughness = 0;
      continue;
    }
    triangle.material = first + mix64(t) % 8;
    scene.smooth[t] = t % 2;
    for (uint32_t v : triangle.vertex)
      scene.normals[v] = Vec3f(normalize(shape_of(scene, t).normal + Vec3d(0.2, 0.1, -0.1)));
  }
  PunctualLight lamp;
  lamp.position = scene.frame.to_canonical({3, 1, 0.3});
  lamp.intensity = Rgb(0.05f);
  scene.lights.push_back(lamp);
  lamp.kind = PunctualLight::Kind::spot;
  lamp.direction = normalize(Vec3d(-1, -1, 0.5));
  lamp.cos_inner = 0.95, lamp.cos_outer = 0.7;
  scene.lights.push_back(lamp);
  lamp.kind = PunctualLight::Kind::directional;
  scene.lights.push_back(lamp);
  return scene;
}

/// The same under clear coats with tilted normals, some of them smooth, and with sheens; the
/// emitter too.
inline Scene coated_rooms() {
  Scene scene = glossy_rooms();
  scene.images.push_back({1, 1, {170, 100, 230, 255}});  // a normal
  scene.uv[0].resize(scene.positions.size());
  scene.tangents.assign(scene.positions.size(), {0.6f, 0.64f, 0.48f, 1});
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    Material& m = scene.materials[i];
    m.plain = false;
    m.coat = i % 4 == 3 ? 0 : 1 - 0.1f * static_cast<float>(i % 5);
    m.coat_roughness = i % 2 == 0 ? 0 : 0.3f + 0.05f * static_cast<float>(i % 7);
    if (i % 3 != 0) m.maps[MAP_COAT_NORMAL].image = 0;
    if (i % 3 != 1) m.sheen_color = {0.6f, 0.4f, 0.3f}, m.sheen_roughness = 0.5f;
  }
  return scene;
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
