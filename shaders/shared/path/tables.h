// Bindings of the renderer's kernels: the tables of a scene and of a submission, and words for
// counts. GLSL makes its buffers from these lists [shaders/path_bindings.glsl], C++ the memory
// bound to them. Includes every header that the texts of this folder need before them.
#ifndef TDPT_SHADERS_SHARED_PATH_TABLES_H
#define TDPT_SHADERS_SHARED_PATH_TABLES_H

#include "shaders/shared/bvh.h"
#include "shaders/shared/elementary.h"
#include "shaders/shared/path/lights_layout.h"
#include "shaders/shared/path/microfacet.h"
#include "shaders/shared/path/point.h"
#include "shaders/shared/path/portal_layout.h"
#include "shaders/shared/path/render_layout.h"
#include "shaders/shared/path/surface_layout.h"
#include "shaders/shared/records.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/scaled.h"
#include "shaders/shared/sequence.h"
#include "shaders/shared/tables.h"
#include "shaders/shared/texels.h"
#include "shaders/shared/warp.h"

#include "shaders/shared/language.h"

#define SCENE_TABLES(TABLE)               \
  TABLES_OF_BVH(TABLE)                    \
  TABLE(uvec4, sobol_point, sobol_points) \
  TABLES_OF_SURFACES(TABLE)               \
  TABLES_OF_LIGHTS(TABLE)                 \
  TABLES_OF_PORTALS(TABLE)

// Of a submission: TABLE(binding, type, name, array, count). Kernels read them as texels and write
// them as storage buffers; `count` is a C++ expression in a Room `room` [device/machine.h].
#define PATH_TABLES(TABLE)                                                                    \
  TABLE(3, uint, cache_offset, cache_offsets, kMostOfCache)                                   \
  TABLE(4, uint, alive, alive, room.flags())                                                  \
  TABLE(5, uint, rank, ranks, room.flags())                                                   \
  TABLE(6, uint, end_first, end_first, room.samples + 1)                                      \
  TABLE(7, uint, walk_last, walk_last, room.samples)                                          \
  TABLE(8, PathVertex, path_vertex, path_vertices, room.vertices)                             \
  TABLE(9, PathDensity, path_density, path_densities, room.vertices)                          \
  TABLE(10, WalkRay, walk_ray, walk_rays, 2 * room.samples)                                   \
  TABLE(11, Connection, connection, connections, room.connections())                          \
  TABLE(12, Scattering, scattering, scatterings, 2 * room.connections())                      \
  TABLE(13, ConnectionEnd, connection_end, connection_ends, room.vertices + 2 * room.samples) \
  TABLE(14, PortalSegment, segment, segments, room.samples)                                   \
  TABLE(15, SegmentSide, segment_side, segment_sides, kSegmentSides* room.samples)            \
  TABLE(16, uint, lit_segment, lit_segments, room.samples)                                    \
  TABLE(17, uint, lit_first, lit_first, room.samples + 1)                                     \
  TABLE(18, float, estimate, estimates, room.estimates())                                     \
  TABLE(19, PathBsdf, path_bsdf, path_bsdfs, layered ? room.vertices : 0)                     \
  TABLE(20, uint, walk_count, walk_counts, room.samples + 1)                                  \
  TABLE(21, uint, flag, flags, room.flags() + 1)
#define FILM_BINDING 22  // film_words

SHARED_BEGIN

// zero_T(): a record T that is 0 in all members.
#define ZERO_VEC(a, type, b) \
  r.a = vec3(0.0f);          \
  r.b = type(0);
#define ZERO_WORDS(type0, a, type1, b, type2, c, type3, d) \
  r.a = type0(0);                                          \
  r.b = type1(0);                                          \
  r.c = type2(0);                                          \
  r.d = type3(0);
#define ZERO(T)                                     \
  SHARED T zero_##T() {                             \
    T r;                                            \
    TEXELS_OF_##T(ZERO_VEC, ZERO_WORDS, ) return r; \
  }
ZERO(PathVertex)
ZERO(WalkRay)
ZERO(Scattering)
ZERO(Connection)
ZERO(ConnectionEnd)
ZERO(SegmentSide)

/// Where each table begins among the texels of the submission or of the scene.
struct FirstTexels {
#define FIRST_OF_PATH(binding, type, name, array, count) uint name;
#define FIRST_OF_SCENE(type, name, array) uint name;
  PATH_TABLES(FIRST_OF_PATH)
  SCENE_TABLES(FIRST_OF_SCENE)
#undef FIRST_OF_PATH
#undef FIRST_OF_SCENE
};

/// Layout as std140: nested structs begin at multiples of 16 bytes.
struct AllSettings {
  RenderParameters render;
  GuideParameters guiding;
  LightSettings lights;
  FirstTexels first_texels;
};

#ifdef __cplusplus
static_assert(offsetof(AllSettings, guiding) % 16 == 0 && offsetof(AllSettings, lights) % 16 == 0 &&
              offsetof(AllSettings, first_texels) % 16 == 0 && sizeof(SkyTable) % 16 == 0);
#endif

SHARED_END

#include "shaders/shared/language_end.h"

#endif
