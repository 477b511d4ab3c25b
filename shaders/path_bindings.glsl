// What the renderer's kernels bind, by the names that shaders/shared/path/ knows; what a kernel
// does not read is not bound. Whether a scene has what only some have is told when a kernel is made
// for it (tools/tdpt-render/device/gpu_machine.cpp).
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
layout(constant_id = 14) const bool scene_has_panels = true;
layout(constant_id = 15) const bool scene_has_windows = true;
layout(constant_id = 16) const bool scene_prefers = true;
layout(constant_id = 17) const bool scene_has_portals = true;
layout(constant_id = 18) const bool portals_have_pairs = true;
layout(constant_id = 19) const bool guide_active = true;
layout(constant_id = 20) const bool camera_culls = true;
layout(constant_id = 21) const uint mixture_techniques = 31u;  // bits
layout(constant_id = 22) const bool power_heuristic = true;
layout(constant_id = 23) const bool film_has_layers = true;
layout(constant_id = 24) const bool film_is_transparent = true;

struct AllSettings {
  RenderParameters render;
  GuideParameters guiding;
  LightSettings lights;
  uvec4 first_texels[kFirstTexels];
};
layout(std140, binding = 2) uniform Settings { AllSettings all_settings[1]; };
RenderParameters render;
GuideParameters guiding;
LightSettings light_settings;

// Before anything else. Mesa's software device compiles a kernel anew for each dispatch when a loop
// or a branch goes by numbers of a uniform buffer alone, unless it does not know where they lie.
void read_settings() {
  uint zero = gl_WorkGroupID.y;
  render = all_settings[zero].render;
  guiding = all_settings[zero].guiding;
  light_settings = all_settings[zero].lights;
}
uint first_texel(uint table) {
  return all_settings[0].first_texels[table >> 2u][table & 3u];
}
#include "shaders/path_tables.glsl"

// What kernels write.
layout(std430, binding = 3) buffer Vertices { PathVertex path_vertices[]; };
layout(std430, binding = 4) buffer Bsdfs { PathBsdf path_bsdfs[]; };
layout(std430, binding = 5) buffer Densities { PathDensity path_densities[]; };
layout(std430, binding = 6) buffer Counts { uint walk_counts[]; };
layout(std430, binding = 7) buffer Lasts { uint walk_last[]; };
layout(std430, binding = 8) buffer Alive { uint alive[]; };
layout(std430, binding = 9) buffer Rays { WalkRay walk_rays[]; };
layout(std430, binding = 10) buffer Ends { JoinEnd join_ends[]; };
layout(std430, binding = 11) buffer Joinings { Joining joinings[]; };
layout(std430, binding = 12) buffer Scatterings { Scattering scatterings[]; };
layout(std430, binding = 13) buffer Segments { PortalSegment segments[]; };
layout(std430, binding = 14) buffer Sides { SegmentSide segment_sides[]; };
layout(std430, binding = 15) buffer FilmWords { uint film_words[]; };
layout(std430, binding = 16) buffer Flags { uint flags[]; };
layout(std430, binding = 17) buffer LitSegments { uint lit_segments[]; };
layout(std430, binding = 18) buffer LitFirst { uint lit_first[]; };
layout(std430, binding = 19) buffer Estimates { float estimates[]; };

layout(push_constant) uniform Work { StepParameters work; };

uint tally_bucket() {
  return gl_WorkGroupID.x % kTallyBuckets;
}
