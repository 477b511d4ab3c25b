// What the renderer's kernels bind, by the names that shaders/shared/path/ knows; what a kernel does
// not read is not bound. Whether a scene has what only some have is told when a kernel is made for
// it (tools/tdpt-render/device/gpu_machine.cpp).
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

layout(binding = 0) uniform usamplerBuffer bvh_nodes;
layout(binding = 1) uniform usamplerBuffer bvh_triangles;
layout(std430, binding = 2) readonly buffer Faces { Face faces[]; };
layout(std430, binding = 3) readonly buffer Corners { FaceCorners face_corners[]; };
layout(std430, binding = 4) readonly buffer Attributes { CornerAttributes corner_attributes[]; };
layout(std430, binding = 5) readonly buffer Materials { SurfaceMaterial materials[]; };
layout(std430, binding = 6) readonly buffer Maps { SurfaceMap texture_maps[]; };
layout(std430, binding = 7) readonly buffer Texels { uint texel_words[]; };
layout(std430, binding = 8) readonly buffer Curves { float surface_curves[]; };
layout(std430, binding = 9) readonly buffer CoverageOf { uint coverage_of[]; };
layout(std430, binding = 10) readonly buffer Coverages { Coverage coverages[]; };
layout(std430, binding = 11) readonly buffer LightWords { uint light_words[]; };
layout(std430, binding = 12) readonly buffer Emitters { Emitter light_emitters[]; };
layout(std430, binding = 13) readonly buffer Lamps { Lamp light_lamps[]; };
layout(std430, binding = 14) readonly buffer Suns { SkySun sky_suns[]; };
layout(std430, binding = 15) readonly buffer SkyTexels { SkyTexel sky_texels[]; };
layout(std430, binding = 16) readonly buffer Panels { Panel light_panels[]; };
layout(std430, binding = 17) readonly buffer Windows { SkyWindow sky_windows[]; };
layout(std430, binding = 18) readonly buffer Frames { WindowFrame window_frames[]; };
layout(std430, binding = 19) readonly buffer Settings {
  RenderParameters render;
  GuideParameters guiding;
  LightSettings light_settings;
  uint pool_offsets[];
};
layout(std430, binding = 20) readonly buffer Facets { PortalFacet portal_facets[]; };
layout(std430, binding = 21) readonly buffer Polygons { PortalPolygon portal_polygons[]; };
layout(std430, binding = 22) readonly buffer FacetCorners { PortalCorner portal_corners[]; };
layout(std430, binding = 23) readonly buffer Pairs { PortalPair portal_pairs[]; };
layout(std430, binding = 24) readonly buffer SobolPoints { uvec4 sobol_points[]; };
layout(std430, binding = 25) buffer Vertices { PathVertex path_vertices[]; };
layout(std430, binding = 26) buffer Densities { PathDensity path_densities[]; };
layout(std430, binding = 27) buffer WalkCounts { uint walk_counts[]; };
layout(std430, binding = 28) buffer WalkLast { uint walk_last[]; };
layout(std430, binding = 29) buffer Alive { uint alive[]; };
layout(std430, binding = 30) readonly buffer EndFirst { uint end_first[]; };
layout(std430, binding = 31) buffer Ends { JoinEnd join_ends[]; };
layout(std430, binding = 32) buffer Segments { PortalSegment segments[]; };
layout(std430, binding = 33) buffer Sides { SegmentSide segment_sides[]; };
layout(std430, binding = 34) buffer FilmWords { uint film_words[]; };
layout(std430, binding = 35) buffer Flags { uint flags[]; };
layout(std430, binding = 36) readonly buffer Ranks { uint ranks[]; };
layout(std430, binding = 37) buffer Bsdfs { PathBsdf path_bsdfs[]; };
layout(std430, binding = 38) buffer Rays { WalkRay walk_rays[]; };
layout(std430, binding = 39) buffer Joinings { Joining joinings[]; };
layout(std430, binding = 40) buffer Scatterings { Scattering scatterings[]; };

layout(push_constant) uniform Work { StepParameters work; };

uint tally_bucket() {
  return gl_WorkGroupID.x % kTallyBuckets;
}
