// Lists of the tables that the shared code reads, TABLE(type, name, array) each: type
// load_name(uint i) is array[i]. C++ has arrays for them, kernels buffers, or texels where that is
// faster [records.h]. Tables are laid out in the order of the list.
#ifndef TDPT_SHADERS_SHARED_TABLES_H
#define TDPT_SHADERS_SHARED_TABLES_H

#ifdef __cplusplus
#define LOADS(type, name, array)          \
  const type& load_##name(uint i) const { \
    return array[i];                      \
  }
// A member that refers to the table without owning it.
#define REFERS_TO(type, name, array) \
  const type* array;                 \
  LOADS(type, name, array)
#else
#define LOADS(type, name, array) \
  type load_##name(uint i) {     \
    return array[i];             \
  }
#endif

#define TABLES_OF_BVH(TABLE)          \
  TABLE(BvhNode, bvh_node, bvh_nodes) \
  TABLE(BvhTriangle, bvh_triangle, bvh_triangles)
#define TABLES_OF_COVERAGE(TABLE)          \
  TABLE(uint, coverage_index, coverage_of) \
  TABLE(Coverage, coverage, coverages)     \
  TABLE(uint, texel_word, texel_words)
#define TABLES_OF_SURFACES(TABLE)                               \
  TABLE(Face, face, faces)                                      \
  TABLE(SurfaceMaterial, material, materials)                   \
  TABLE(uint, material_map, material_maps)                      \
  TABLE(SurfaceMap, texture_map, texture_maps)                  \
  TABLE(FaceCorners, face_corners, face_corners)                \
  TABLE(CornerAttributes, corner_attributes, corner_attributes) \
  TABLE(float, surface_curve, surface_curves)                   \
  TABLE(float, sheen_curve, sheen_curves)                       \
  TABLES_OF_COVERAGE(TABLE)
#define TABLES_OF_LIGHTS(TABLE)                 \
  TABLE(uint, light_word, light_words)          \
  TABLE(Emitter, light_emitter, light_emitters) \
  TABLE(Lamp, light_lamp, light_lamps)          \
  TABLE(SkySun, sky_sun, sky_suns)              \
  TABLE(SkyTexel, sky_texel, sky_texels)        \
  TABLE(RectLight, rect_light, rect_lights)     \
  TABLE(SkyWindow, sky_window, sky_windows)     \
  TABLE(WindowFrame, window_frame, window_frames)
#define TABLES_OF_PORTALS(TABLE)                        \
  TABLE(PortalFacet, portal_facet, portal_facets)       \
  TABLE(PortalPolygon, portal_polygon, portal_polygons) \
  TABLE(PortalCorner, portal_corner, portal_corners)    \
  TABLE(PortalPair, portal_pair, portal_pairs)

#endif
