// The scalar build of the kernels' code on lights.
#pragma once
#include "shaders/shared/tables.h"
#include "tools/tdpt-render/device/tables.h"

namespace tdpt::shader {

/// Refers to the tables.
struct ScalarLights {
  using Real = float;
  TABLES_OF_LIGHTS(REFERS_TO)
  const LightSettings& light_settings;
  bool scene_has_sky, scene_has_sky_map, scene_has_lamps, scene_has_rect_lights, scene_has_windows,
      scene_prefers;

  explicit ScalarLights(const LightTables& t)
      : light_words(t.words.data()),
        light_emitters(t.emitters.data()),
        light_lamps(t.lamps.data()),
        sky_suns(t.suns.data()),
        sky_texels(t.texels.data()),
        rect_lights(t.rect_lights.data()),
        sky_windows(t.windows.data()),
        window_frames(t.frames.data()),
        light_settings(t.settings),
        scene_has_sky(t.has_sky),
        scene_has_sky_map(t.has_sky_map),
        scene_has_lamps(t.has_lamps),
        scene_has_rect_lights(t.has_rect_lights),
        scene_has_windows(t.has_windows),
        scene_prefers(t.prefers) {}

#include "shaders/shared/path/lighting.h"
};

}  // namespace tdpt::shader
