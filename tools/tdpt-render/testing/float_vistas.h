// For tests: vistas with lights, portals and surfaces of all kinds, and what kernels make of them
// in floats.
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "tools/tdpt-render/testing/rect_lights.h"
#include "tools/tdpt-render/testing/scalar_kernels.h"
#include "tools/tdpt-render/testing/stages.h"

namespace tdpt {

/// A vista and its scalar build. They refer to each other, so neither may be moved.
struct FloatVista {
  std::string name;
  Scene scene;
  Vista vista;
  RenderTables tables;
  shader::ScalarKernels floats;

  /// `change` what the tables are made from.
  FloatVista(
      std::string name_, Scene scene_, const std::vector<Portal>& portals = {},
      const std::function<void(Vista&)>& change = [](Vista&) {})
      : name(std::move(name_)),
        scene(std::move(scene_)),
        vista(scene, scene.cameras[0], 4, 4, portals),
        tables((change(vista), vista)),
        floats(shader::kernels_of(tables)) {}
  FloatVista(const FloatVista&) = delete;
};
using FloatVistas = std::vector<std::unique_ptr<FloatVista>>;

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

/// In the open end, in the hole, and a triangle.
inline std::vector<Portal> three_windows() {
  return {
      rectangle({4.1, 0.1, -0.9}, {0, 0, 1.8}, {0, 1.8, 0}),
      rectangle({2.05, 0.875, -0.125}, {0, 0, 0.25}, {0, 0.25, 0}),
      {"triangle", {{2.5, 0.3, 0.2}, {3.5, 1.9, 0.3}, {2.6, 1.8, 0.3}}, {{0, 1, 2}}, {}, {}, true}};
}

inline FloatVistas lit_vistas() {
  FloatVistas all;
  const auto add = [&](const char* name, Scene scene, const std::vector<Portal>& portals) {
    all.push_back(std::make_unique<FloatVista>(name, std::move(scene), portals));
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
  // As the pilot may ask for.
  all.push_back(std::make_unique<FloatVista>(
      "other shares", open_room(uneven_sky()), std::vector<Portal>{}, [](Vista& v) {
        v.openings = Openings(*v.world, {}, Lights::KindProbabilities{0.1, 0.2, 0.3, 0.4});
      }));
  return all;
}

/// Parallelogram about `centre` with half sides u and v; light crosses it along cross(u, v).
inline Portal plate(const Vec3d& centre, const Vec3d& u, const Vec3d& v) {
  const Vec3d p = centre - u - v;
  return {"plate", {p, p + u * 2, p + u * 2 + v * 2, p + v * 2}, {{0, 1, 2}, {0, 2, 3}}, {}};
}

/// Portals in [-1,1]^3.
inline FloatVistas vistas_with_portals() {
  FloatVistas all;
  const Scene rooms = read_gltf(two_rooms_path());
  const auto add = [&](const char* name, const std::vector<Portal>& portals,
                       const Frame& frame = {}) {
    const PortalSet set(portals, frame);
    all.push_back(std::make_unique<FloatVista>(name, rooms, std::vector<Portal>{},
                                               [&](Vista& v) { v.openings.portals = set; }));
  };
  const std::vector<Portal> one{plate({0.2, 0.1, 0.3}, {0, 0.25, 0}, {0.2, 0, 0.05})};
  std::vector<Portal> aside = one;
  aside.push_back(plate({-0.5, 0, 0.4}, {0, 0.3, 0}, {0, 0, 0.4}));
  aside.push_back(plate({-0.1, 0.6, 0.1}, {0.45, 0, 0}, {0, 0, 0.3}));
  aside.back().both_ways = true;
  // A slit of 1 to 80, in 12 triangles.
  Portal slit{"slit", {}, {}, {}};
  const Onb<double> onb(normalize(Vec3d(0.3, 0.8, -0.5)));
  for (int i = 0; i <= 6; ++i)
    for (const double across : {-0.005, 0.005})
      slit.vertices.push_back(onb.to_world({across, 0.8 * (i / 3.0 - 1), 0.1}));
  for (uint32_t i = 0; i < 6; ++i) {
    slit.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 3});
    slit.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 2});
  }
  // Two layers of five by `rows` portals, one after the other on the light's way: each with each is
  // a pair.
  const auto layers = [](int rows) {
    std::vector<Portal> portals;
    for (int i = 0; i < 10 * rows; ++i)
      portals.push_back(
          plate({0.32 * (i / 2 % 5) - 0.64, 0.4 * (i / 10) - 0.2 * (rows - 1), 0.5 * (i % 2) - 0.2},
                {0.12, 0.01, 0}, {0, 0.15, 0.02}));
    return portals;
  };
  add("one", one);
  add("aside and both ways", aside);
  add("slit", {slit});
  add("layers", layers(2));
  add("more than a word has bits", layers(4));
  add("rooms", two_crossing_portals(), rooms.frame);
  return all;
}

/// Four random numbers with the precision of floats.
struct FourNumbers {
  float pick, u, v, side;
  FourNumbers(uint64_t seed, uint64_t i) {
    Rng rng(seed, 0, i);
    const auto next = [&] { return rng.uniform_float(); };
    pick = next(), u = next(), v = next(), side = next();
  }
};

}  // namespace tdpt
