// LOADS(type, name, array): type load_name(uint i), which reads array[i]. By functions of that name
// texts read tables; C++ has arrays for them, kernels buffers, or texels where that is faster
// [cmake/shader-tables.sh].
#ifndef TDPT_SHADERS_SHARED_LOADS_H
#define TDPT_SHADERS_SHARED_LOADS_H

#ifdef __cplusplus
#define LOADS(type, name, array)          \
  const type& load_##name(uint i) const { \
    return array[i];                      \
  }
#else
#define LOADS(type, name, array) \
  type load_##name(uint i) {     \
    return array[i];             \
  }
#endif

// Of surfaces, of lights, of portals.
#define LOADS_OF_COVERAGE                  \
  LOADS(uint, coverage_index, coverage_of) \
  LOADS(Coverage, coverage, coverages)     \
  LOADS(uint, texel_word, texel_words)
#define LOADS_OF_SURFACES                                       \
  LOADS(Face, face, faces)                                      \
  LOADS(FaceCorners, face_corners, face_corners)                \
  LOADS(CornerAttributes, corner_attributes, corner_attributes) \
  LOADS(SurfaceMaterial, material, materials)                   \
  LOADS(uint, material_map, material_maps)                      \
  LOADS(SurfaceMap, texture_map, texture_maps)                  \
  LOADS(float, surface_curve, surface_curves)                   \
  LOADS_OF_COVERAGE
#define LOADS_OF_LIGHTS                         \
  LOADS(uint, light_word, light_words)          \
  LOADS(Emitter, light_emitter, light_emitters) \
  LOADS(Lamp, light_lamp, light_lamps)          \
  LOADS(SkySun, sky_sun, sky_suns)              \
  LOADS(SkyTexel, sky_texel, sky_texels)        \
  LOADS(Panel, light_panel, light_panels)       \
  LOADS(SkyWindow, sky_window, sky_windows)     \
  LOADS(WindowFrame, window_frame, window_frames)
#define LOADS_OF_PORTALS                                \
  LOADS(PortalFacet, portal_facet, portal_facets)       \
  LOADS(PortalPolygon, portal_polygon, portal_polygons) \
  LOADS(PortalCorner, portal_corner, portal_corners)    \
  LOADS(PortalPair, portal_pair, portal_pairs)

#endif
