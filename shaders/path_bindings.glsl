// Bindings of the renderer's kernels, under the names that shaders/shared/path/ expects; tables
// that a kernel does not read are not bound. The constants say which optional features the scene
// has; they are set when a kernel is created for the scene
// (tools/tdpt-render/device/gpu_renderer.cpp).
#include "shaders/shared/path/tables.h"

layout(local_size_x = 64) in;

layout(constant_id = 0) const bool scene_has_layers = true;
layout(constant_id = 1) const bool scene_has_normals = true;
layout(constant_id = 2) const bool scene_has_textures = true;
layout(constant_id = 3) const bool scene_has_colours = true;
layout(constant_id = 4) const bool scene_has_coats = true;
layout(constant_id = 5) const bool scene_has_sheen = true;
layout(constant_id = 6) const bool scene_has_transmission = true;
layout(constant_id = 7) const bool scene_has_absorption = true;
layout(constant_id = 8) const bool scene_has_panes = true;
layout(constant_id = 9) const bool scene_has_coverage = true;
layout(constant_id = 10) const bool coverage_has_textures = true;
layout(constant_id = 11) const bool scene_has_sky = true;
layout(constant_id = 12) const bool scene_has_sky_map = true;
layout(constant_id = 13) const bool scene_has_lamps = true;
layout(constant_id = 14) const bool scene_has_rect_lights = true;
layout(constant_id = 15) const bool scene_has_windows = true;
layout(constant_id = 16) const bool scene_prefers = true;
layout(constant_id = 17) const bool scene_has_portals = true;
layout(constant_id = 18) const bool portals_have_pairs = true;
layout(constant_id = 19) const bool guide_active = true;
layout(constant_id = 20) const bool camera_culls = true;
layout(constant_id = 21) const uint mixture_techniques = 31u;  // bits
layout(constant_id = 22) const bool power_heuristic = true;
layout(constant_id = 23) const bool film_has_layers = true;
layout(constant_id = 24) const bool film_has_halves = true;
layout(constant_id = 25) const bool film_is_transparent = true;

layout(std140, binding = 2) uniform Settings { AllSettings all_settings[1]; };
RenderParameters render;
GuideParameters guiding;
LightSettings light_settings;

// Call this first. Mesa's software device recompiles a kernel for each dispatch if a loop or branch
// depends only on values from a uniform buffer, unless their index is unknown to it; `zero` hides
// it.
void read_settings() {
  uint zero = gl_WorkGroupID.y;
  render = all_settings[zero].render;
  guiding = all_settings[zero].guiding;
  light_settings = all_settings[zero].lights;
}

layout(binding = 0) uniform usamplerBuffer path_texels;
#define BIND(number, type, name, array, count)                              \
  type load_##name(uint i) {                                                \
    return entry_##type(path_texels, all_settings[0].first_texels.name, i); \
  }                                                                         \
  layout(std430, binding = number) buffer Written_##array { type array[]; };
PATH_TABLES(BIND)
layout(std430, binding = FILM_BINDING) buffer Film { uint film_words[]; };

layout(binding = 1) uniform usamplerBuffer scene_texels;
#define READ(type, name, array)                                              \
  type load_##name(uint i) {                                                 \
    return entry_##type(scene_texels, all_settings[0].first_texels.name, i); \
  }
SCENE_TABLES(READ)

layout(push_constant) uniform Work { StepParameters work; };

uint tally_bucket() {
  return gl_WorkGroupID.x % kTallyBuckets;
}
