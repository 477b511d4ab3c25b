// For tests: scenes that between them use every feature of the kernels.
#pragma once
#include <filesystem>

#include "libcommon/scene/ies.h"
#include "libcommon/testing/files/ies_text.h"
#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/glossy_rooms.h"
#include "libcommon/testing/rooms/known_rooms.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/sheets.h"
#include "tools/tdpt-render/testing/sky.h"

namespace tdpt {

/// A scene with its portals and settings.
struct Stage {
  std::string name;
  Scene scene;
  std::vector<Portal> portals;
  bool alpha = false;

  Vista vista(int width = 32, int height = 24) const {
    return Vista(scene, scene.camera(""), width, height, portals);
  }
};

inline Scene read_bytes(const std::string& glb) {
  const testing::TempFolder folder;
  return read_gltf(folder.write("scene.glb", glb));
}

inline const Portal kWideWindow = rectangle({2.05, 0.5, -0.5}, {0, 0, 1}, {0, 1, 0});

/// One portal behind another, so that there are pairs.
inline Stage two_rooms_stage() {
  return {"two_rooms", read_gltf(two_rooms_path()), two_crossing_portals()};
}

/// Lamps of many powers, most of them two-sided; a door of many triangles.
inline Stage door_stage() {
  Scene scene = read_gltf(TDPT_TESTDATA "/scenes/door-ajar.glb");
  for (size_t i = 0; i < 40; ++i) {
    Material lamp = scene.materials[0];
    lamp.emission = Rgb(std::pow(10.0f, 0.1f * static_cast<float>(i) - 3), 0.1f, 0.02f);
    lamp.double_sided = i % 3 != 0;
    scene.materials.push_back(lamp);
  }
  const auto materials = static_cast<uint32_t>(scene.materials.size());
  for (size_t i = 3; i < scene.triangles.size(); i += 3)
    scene.triangles[i].material = materials - 40 + static_cast<uint32_t>(i / 3 % 40);
  return {"door", scene, {rectangle({2.05, 0.02, -0.4}, {0, 0, 0.8}, {0, 1.8, 0})}};
}

/// Rooms with every material, textures and sheets; without any that excludes another.
inline Scene scene_of_materials(testing::GlossyRooms::Light light) {
  Scene scene = read_bytes(testing::glossy_rooms({.plastic_floor = true,
                                                  .metal_walls = true,
                                                  .mirror = true,
                                                  .glass = true,
                                                  .smooth = true,
                                                  .textures = true,
                                                  .screen = true,
                                                  .coats = true,
                                                  .light = light}));
  for (Material& m : scene.materials)
    if (m.solid) m.absorption = {0.5f, 1, 2};
  Material frosted = clear_pane();
  frosted.roughness = 0.3f;
  double x = 1.6;
  for (const Material& sheet : {clear_pane(), frosted, veil(0.5f)})
    scene = with_sheet(scene, sheet, {x += 0.05, 0.3, -0.6}, {0, 0, 1.2}, {0, 1.4, 0});
  scene.colours.resize(scene.positions.size(), {1, 1, 1, 1});
  for (size_t i = 0; i < scene.positions.size(); i += 2) scene.colours[i] = {0.9f, 0.7f, 1, 1};
  for (Material& m : scene.materials) m.coloured = true, m.plain = false;
  return scene;
}
inline Stage materials_stage() {
  return {
      "materials", scene_of_materials(testing::GlossyRooms::Light::textured_lamp), {kWideWindow}};
}

inline void add_lamps_without_surface(Scene& scene) {
  using Kind = PunctualLight::Kind;
  for (const Kind kind : {Kind::point, Kind::spot, Kind::directional}) {
    PunctualLight light;
    light.kind = kind;
    light.position = scene.frame.to_canonical({3.2, 1.6, kind == Kind::spot ? 0.3 : -0.2});
    light.direction = normalize(Vec3d{-1, -0.3, 0.1});
    light.intensity = Rgb(kind == Kind::directional ? 0.5f : 0.05f);
    light.cos_inner = 0.95, light.cos_outer = 0.7;
    scene.lights.push_back(light);
  }
}
/// Two lamps of one profile and one of another.
inline Scene with_luminaires(Scene scene) {
  const testing::IesText even{.vertical = {0, 45, 120}, .candela = {3, 2, 1}};
  const testing::IesText uneven{.vertical = {0, 10, 30, 75},
                                .horizontal = {0, 90, 180},
                                .candela = {9, 8, 5, 0, 9, 7, 1, 2, 9, 9, 9, 0}};
  PunctualLight lamp;
  for (const Vec3d& towards : {Vec3d(0, -1, 0), Vec3d(1, 2, -0.4), Vec3d(-1, 0.1, 0)}) {
    if (!lamp.profile || lamp.profile->words.size() < 10)
      lamp.profile = std::make_shared<LightProfile>(
          read_ies((lamp.profile ? uneven : even).text(), "lamp.ies", ""));
    lamp.position = scene.frame.to_canonical(Vec3d{3, 1, 0} + 0.4 * towards);
    lamp.direction = normalize(towards);
    lamp.across = normalize(cross(lamp.direction, Vec3d(0.3, 0.1, 1)));
    lamp.intensity = Rgb(1, 0.8f, 0.5f);
    scene.lights.push_back(lamp);
  }
  return scene;
}

/// Lamps without surface of all kinds, lighting surfaces that are more than diffuse.
inline Stage lamps_stage() {
  Scene scene = read_bytes(testing::glossy_rooms(
      {.plastic_floor = true, .smooth = true, .light = testing::GlossyRooms::Light::sun}));
  add_lamps_without_surface(scene);
  return {"lamps", scene, {kWideWindow}};
}

inline const Sky::Sun kLowSun = sun_of({1, 0.45, 0.2}, 0.25 * kDegree, 5);

/// Surfaces that are more than diffuse, all of them opaque.
inline Stage solids_stage() {
  return {"solids",
          read_bytes(testing::glossy_rooms({.plastic_floor = true,
                                            .metal_walls = true,
                                            .glass = true,
                                            .smooth = true,
                                            .textures = true,
                                            .coats = true})),
          {kWideWindow}};
}

/// A room under sky and sun: a window with two portals at an angle, both ways, and one without.
inline Stage sky_stage() {
  Scene scene = without_lamps(open_end(read_bytes(testing::glossy_rooms({})), 2.09));
  scene = without(scene, [](const Vec3d& p) { return p.z < -0.99 && p.y > p.x - 0.01; });
  Portal half = rectangle({2.05, 0.5, -0.5}, {0, 0, 0.5}, {0, 1, 0}),
         other = rectangle({2.05, 0.5, 0}, {0.1, 0, 0.5}, {0, 1, 0});
  half.both_ways = other.both_ways = true;
  return {"sky", under(scene, uneven_sky({kLowSun})), {half, other}};
}

/// A camera that sees through the wall in front of it, with a transparent film.
inline Stage culling_stage() {
  Scene scene = read_gltf(TDPT_TESTDATA "/scenes/window.glb");
  for (Material& m : scene.materials) m.double_sided = false;
  scene.materials[0].alpha = 0.5f;  // also in front of the sky
  scene.materials[0].alpha_mode = Material::Alpha::blend;
  scene.materials[0].plain = false;
  const Vec3d from{-1.5, 1.3, 0.4}, to{2, 1, -0.1};
  Camera& camera = scene.cameras[0];
  camera.position = scene.frame.to_canonical(from);
  camera.forward = normalize(to - from);
  camera.right = normalize(cross(camera.forward, Vec3d{0, 1, 0}));
  camera.up = cross(camera.right, camera.forward);
  camera.culls = true;
  return {"culling",
          under(scene, one_colour_sky(Rgb(0.5f))),
          {rectangle({2.05, 0.2, -0.8}, {0, 0, 1.6}, {0, 1.6, 0})},
          true};
}

/// All materials, all kinds of light, portals of several facets.
inline Stage everything_stage() {
  Scene scene = scene_of_materials(testing::GlossyRooms::Light::mirror_lamp);
  scene = open_end(scene, 4.05);
  add_lamps_without_surface(scene);
  std::vector<Portal> portals{kWideWindow, rectangle({4.1, 0, -1}, {0, 0, 2}, {0, 2, 0})};
  portals[1].both_ways = true;
  const auto sky = std::make_shared<Sky>(fine_map(Rgb(2)), 0.3, std::vector{kLowSun});
  return {"everything", under(with_luminaires(scene), sky), portals, true};
}

/// A generated room, with portals in its apertures.
inline Stage known_stage(testing::RoomKind kind, uint64_t seed) {
  const testing::KnownRoom room = known_room(kind, seed);
  Stage stage{testing::name_of(kind), read_bytes(room.plan.glb(room.writing)), {}};
  for (const testing::KnownAperture& aperture : room.placed_apertures()) {
    Portal portal{"aperture", aperture.outline, {}, {}};
    for (uint32_t i = 2; i < aperture.outline.size(); ++i)
      portal.triangles.push_back({0, i - 1, i});
    stage.portals.push_back(portal);
  }
  return stage;
}

}  // namespace tdpt
