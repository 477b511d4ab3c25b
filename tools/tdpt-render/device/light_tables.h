// The lights of a vista in the layout of shaders/shared/path/lights_layout.h, for a device or for
// the scalar build of its kernels.
#pragma once
#include <vector>

#include "shaders/shared/path/lights_layout.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

/// No vector is empty, since no buffer may be.
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

  // Features for which kernels are specialised.
  bool has_sky = false;
  bool has_sky_map = false;  ///< of more than one colour
  bool has_lamps = false;
  bool has_rect_lights = false;
  bool has_windows = false;
  bool prefers = false;  ///< light walks prefer some directions of the sky
};

/// Radiance is divided by `radiance_unit`.
LightTables make_light_tables(const Vista& vista, double radiance_unit);

}  // namespace tdpt
