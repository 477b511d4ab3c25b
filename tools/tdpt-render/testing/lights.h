// For tests: vistas with lights of all kinds, their tables and their scalar build.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "libcommon/scene/ies.h"
#include "libcommon/testing/files/ies_text.h"
#include "tools/tdpt-render/testing/rect_lights.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/scalar_lights.h"
#include "tools/tdpt-render/testing/sky.h"

namespace tdpt {

inline constexpr double kUnit = 0.25;  // power of two of the radiance in tables

/// A vista and its device tables. They refer to each other, so neither may be moved.
struct LitVista {
  std::string name;
  Scene scene;
  Vista vista;
  LightTables tables;
  shader::ScalarLights scalar;

  LitVista(std::string name_, Scene scene_, const std::vector<Portal>& portals)
      : name(std::move(name_)),
        scene(std::move(scene_)),
        vista(scene, scene.cameras[0], 4, 4, portals),
        tables(make_light_tables(vista, kUnit)),
        scalar(tables) {}
  LitVista(const LitVista&) = delete;
};

/// 320 x 160, uneven, with one very bright texel and a black band.
inline Sky::Map fine_map() {
  Sky::Map map{320, 160, {}};
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const float f =
          0.1f + static_cast<float>(mix64(static_cast<uint64_t>(y * map.width + x)) % 64) / 64;
      map.texels.push_back(y > 100 && y < 115 ? Rgb{} : Rgb(f, 0.8f * f, 1.2f * f));
    }
  map.texels[34 * 320 + 250] = Rgb(3000, 2000, 1000);
  return map;
}
inline std::shared_ptr<const Sky> fine_sky() {
  return std::make_shared<Sky>(fine_map(), 0.3,
                               std::vector{sun_of({0.3, 1, 0.4}, 0.5 * kDegree, 4)});
}

inline Scene open_room(std::shared_ptr<const Sky> sky, bool lamps = true) {
  Scene scene = open_end(read_gltf(two_rooms_path()), 4.09);
  PunctualLight lamp;
  lamp.intensity = Rgb(0.5f);
  if (lamps) scene.lights.push_back(lamp);
  lamp.kind = PunctualLight::Kind::directional;
  if (lamps) scene.lights.push_back(lamp);
  return under(scene, std::move(sky));
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
    lamp.direction = normalize(towards);
    lamp.across = normalize(cross(lamp.direction, Vec3d(0.3, 0.1, 1)));
    lamp.intensity = Rgb(1, 0.8f, 0.5f);
    scene.lights.push_back(lamp);
  }
  return scene;
}

/// In the open end, in the hole, and a triangle.
inline std::vector<Portal> three_windows() {
  return {
      rectangle({4.1, 0.1, -0.9}, {0, 0, 1.8}, {0, 1.8, 0}),
      rectangle({2.05, 0.875, -0.125}, {0, 0, 0.25}, {0, 0.25, 0}),
      {"triangle", {{2.5, 0.3, 0.2}, {3.5, 1.9, 0.3}, {2.6, 1.8, 0.3}}, {{0, 1, 2}}, {}, {}, true}};
}

/// All, or those `named`.
inline std::vector<std::unique_ptr<LitVista>> lit_vistas(
    const std::vector<std::string>& named = {}) {
  std::vector<std::unique_ptr<LitVista>> all;
  const auto add = [&](const char* name, Scene scene, const std::vector<Portal>& portals) {
    if (!named.empty() && std::find(named.begin(), named.end(), name) == named.end()) return;
    all.push_back(std::make_unique<LitVista>(name, std::move(scene), portals));
  };
  const auto sun = [](double half_angle) {
    return std::vector{sun_of({0.3, 1, 0.4}, half_angle, 4)};
  };
  add("lamps", glossy_rooms(), {});
  add("luminaires", with_luminaires(glossy_rooms()), {});
  add("rectangular lights", with_rect_lights(glossy_rooms()), {});
  add("colour", open_room(one_colour_sky({1, 2, 3})), {});
  add("colour and windows", open_room(one_colour_sky({1, 2, 3})), three_windows());
  add("uneven", open_room(uneven_sky(sun(12 * kDegree))), {});
  add("uneven and windows", open_room(uneven_sky(sun(12 * kDegree))), three_windows());
  const auto rough = std::make_shared<Sky>(fine_map(), 0.3);
  add("blocks", open_room(rough), {});
  add("blocks and windows", open_room(rough), three_windows());
  add("fine", open_room(fine_sky()), {});
  add("fine and windows", open_room(fine_sky()), three_windows());
  add("sun alone", open_room(std::make_shared<Sky>(Sky::Map{}, 0, sun(kDegree)), false),
      three_windows());
  add("rectangular lights and windows", with_rect_lights(open_room(fine_sky(), false)),
      three_windows());
  return all;
}

/// Four random numbers with the precision of floats.
struct FourNumbers {
  float pick, u, v, side;
  FourNumbers(uint64_t seed, uint64_t i) {
    Rng rng(seed, 0, i);
    const auto next = [&] { return shader::unit_float(static_cast<uint32_t>(rng.bits() >> 32)); };
    pick = next(), u = next(), v = next(), side = next();
  }
};

}  // namespace tdpt
