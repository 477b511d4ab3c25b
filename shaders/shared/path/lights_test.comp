// Test only: the words of lights_test.h, one run per invocation.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/path/words_test.h"
#include "shaders/shared/tables.h"
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Settings { LightSettings light_settings; };
layout(std430, binding = 1) readonly buffer Tables { uint light_words[]; };
layout(std430, binding = 2) readonly buffer Emitters { Emitter light_emitters[]; };
layout(std430, binding = 3) readonly buffer Lamps { Lamp light_lamps[]; };
layout(std430, binding = 4) readonly buffer Suns { SkySun sky_suns[]; };
layout(std430, binding = 5) readonly buffer Texels { SkyTexel sky_texels[]; };
layout(std430, binding = 6) readonly buffer RectLights { RectLight rect_lights[]; };
layout(std430, binding = 7) readonly buffer Windows { SkyWindow sky_windows[]; };
layout(std430, binding = 8) readonly buffer Frames { WindowFrame window_frames[]; };
layout(std430, binding = 9) readonly buffer Places { Shaded shaded_places[]; };
layout(std430, binding = 10) writeonly buffer Words { uint words[]; };
layout(push_constant) uniform Has { uint has; };
bool scene_has_sky = (has & HAS_SKY) != 0u;
bool scene_has_sky_map = (has & HAS_SKY_MAP) != 0u;
bool scene_has_lamps = (has & HAS_LAMPS) != 0u;
bool scene_has_rect_lights = (has & HAS_RECT_LIGHTS) != 0u;
bool scene_has_windows = (has & HAS_WINDOWS) != 0u;
bool scene_prefers = (has & PREFERS) != 0u;
TABLES_OF_LIGHTS(LOADS)
#include "shaders/shared/path/lighting.h"

#include "shaders/shared/path/lights_test.h"

void main() {
  LightWords drawn = light_words_of(gl_GlobalInvocationID.x);
  for (uint k = 0u; k < kLightWords; ++k)
    words[gl_GlobalInvocationID.x * kLightWords + k] = drawn.words[k];
}
