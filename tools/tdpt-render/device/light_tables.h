// The lights of a world as shaders/shared/path/lights_layout.h has them: for a device, or for its
// twin.
#pragma once
#include <vector>

#include "shaders/shared/path/lights_layout.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// No vector is empty, as no buffer may be.
struct LightTables {
  shader::LightSettings settings{};
  std::vector<uint32_t> words;
  std::vector<shader::Emitter> emitters;
  std::vector<shader::Lamp> lamps;
  std::vector<shader::SkySun> suns;
  std::vector<shader::SkyTexel> texels;
  std::vector<shader::RectLight> rect_lights;
  std::vector<shader::SkyWindow> windows;
  std::vector<shader::WindowFrame> frames;

  // What kernels are made for.
  bool has_sky = false;
  bool has_sky_map = false;  ///< of more than one colour
  bool has_lamps = false;
  bool has_rect_lights = false;
  bool has_windows = false;
  bool prefers = false;  ///< walks prefer some directions of the sky
};

/// Radiance is that of the world over `radiance_unit`. As the world is now: portals and shares of
/// lights that change later need tables of their own.
LightTables make_light_tables(const World& world, double radiance_unit);

}  // namespace tdpt
