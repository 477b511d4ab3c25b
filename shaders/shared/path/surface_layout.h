// Layout of surfaces: materials, texture maps, faces, attributes of their corners, and curves.
// std430 in GLSL, the same bytes in C++; libcommon/scene/surface_tables.h fills them. Canonical
// frame; radiance is divided by a power of two.
#ifndef TDPT_SHADERS_SHARED_PATH_SURFACE_LAYOUT_H
#define TDPT_SHADERS_SHARED_PATH_SURFACE_LAYOUT_H

#include "shaders/shared/coverage_layout.h"
#include "shaders/shared/records.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

const uint kNoMap = 0xFFFFFFFFu;

/// Factors of tdpt::Material, linear.
#define TEXELS_OF_SurfaceMaterial(VEC, WORDS, PART)                                          \
  /* base_color: each in [0,1] */                                                            \
  /* flags: MATERIAL_* */                                                                    \
  VEC(base_color, uint, flags)                                                               \
  /* emission: radiance [W/m2/sr], on the front only unless double-sided */                  \
  /* roughness: perceptual; GGX alpha = roughness^2 */                                       \
  VEC(emission, float, roughness)                                                            \
  /* specular: strength of the dielectric reflection, [0,1] */                               \
  VEC(specular_color, float, specular)                                                       \
  /* absorption: inside a solid, per canonical length */                                     \
  /* ior: behind the front side, with 1 in front of it */                                    \
  VEC(absorption, float, ior)                                                                \
  /* sheen_color: each in [0,1] */                                                           \
  /* sheen_roughness: perceptual, [0,1] */                                                   \
  VEC(sheen_color, float, sheen_roughness)                                                   \
  /* transmission: share of the light that passes, of what is not reflected */               \
  WORDS(float, metallic, float, transmission, float, normal_scale, float, coat_normal_scale) \
  /* coat: strength of the clear coat, [0,1] */                                              \
  /* coat_roughness: perceptual, [0,1] */                                                    \
  /* pane_share: share that passes, of what is not reflected; 0: no pane */                  \
  WORDS(float, coat, float, coat_roughness, float, pane_share, float, pane_f0)               \
  /* dip: for a conductor [fresnel.h] */                                                     \
  VEC(dip, float, pane_f90)
RECORD(SurfaceMaterial)
// material_maps[MAPS_OF_MATERIAL material + MAP_*]: index into texture_maps[], or kNoMap; maps are
// applied in this order.
#define MAPS_OF_MATERIAL 12u
#define MAP_BASE 0u
#define MAP_METALLIC_ROUGHNESS 1u
#define MAP_SPECULAR 2u
#define MAP_SPECULAR_COLOR 3u
#define MAP_TRANSMISSION 4u
#define MAP_EMISSION 5u
#define MAP_COAT 6u
#define MAP_COAT_ROUGHNESS 7u
#define MAP_SHEEN_COLOR 8u
#define MAP_SHEEN_ROUGHNESS 9u
#define MAPS_OF_FACTORS 10u  // the maps before it multiply factors
#define MAP_NORMAL 10u
#define MAP_COAT_NORMAL 11u
#define MATERIAL_PLAIN 1u
#define MATERIAL_EMITS 2u
#define MATERIAL_DOUBLE_SIDED 4u
#define MATERIAL_SOLID 8u
#define MATERIAL_GLOSSY_MAP 16u
#define MATERIAL_ABSORBS 32u
#define MATERIAL_BENDS 64u  // has normal maps

/// The same as tdpt::TextureMap.
#define TEXELS_OF_SurfaceMap(VEC, WORDS, PART)                      \
  PART(TexelGrid, grid)                                             \
  /* u_of_u: u' = u_of_u u + u_of_v v + u_shift */                  \
  WORDS(float, u_of_u, float, u_of_v, float, u_shift, uint, uv_set) \
  WORDS(float, v_of_u, float, v_of_v, float, v_shift, uint, pad)
RECORD(SurfaceMap)

#define TEXELS_OF_Face(VEC, WORDS, PART) \
  VEC(p0, uint, material)                \
  /* e1: p1 - p0 */                      \
  /* smoothed: Scene::smooth */          \
  VEC(e1, uint, smoothed)                \
  /* e2: p2 - p0 */                      \
  VEC(e2, uint, pad0)                    \
  /* normal: unit, of the front */       \
  VEC(normal, uint, pad1)
RECORD(Face)

/// The corners of a face in corner_attributes[]; empty if no corner has attributes.
#define TEXELS_OF_FaceCorners(VEC, WORDS, PART) WORDS(uint, a, uint, b, uint, c, uint, pad)
RECORD(FaceCorners)

#define TEXELS_OF_CornerAttributes(VEC, WORDS, PART) \
  /* normal: unit or 0 */                            \
  VEC(normal, float, handedness)                     \
  /* tangent: unit or 0 */                           \
  VEC(tangent, float, alpha)                         \
  VEC(color, float, pad)                             \
  /* u0: first set of texture coordinates */         \
  /* u1: second */                                   \
  WORDS(float, u0, float, v0, float, u1, float, v1)
RECORD(CornerAttributes)

// surface_curves[]: the table of interface_albedo.h, linear light of sRGB bytes, and the nodes of a
// quadrature. sheen_curves[]: the tables of sheen.h, if there is sheen.
const uint kInterfaceCosines = 64u;  ///< nodes; two numbers each
const uint kInterfaceAlphas = 48u;   ///< rows
const uint kInterfaceAverages = 2u * kInterfaceCosines * kInterfaceAlphas;
const uint kLinearOfSrgb = kInterfaceAverages + 2u * kInterfaceAlphas;
const uint kGauss = kLinearOfSrgb + 256u;  ///< nodes 1/2 +- x of [0,1], and weights
const uint kGaussNodes = 6u;
const uint kSurfaceCurves = kGauss + 2u * kGaussNodes;
const uint kSheenCosines = 40u;
const uint kSheenRoughnesses = 24u;
const uint kSheenAlbedos = kSheenCosines * kSheenRoughnesses;  ///< after those of D V
const uint kSheenCurves = 2u * kSheenAlbedos;
const float kLeastSheenRoughness = 0.07f;  ///< lower values are raised to it

#ifdef __cplusplus
static_assert(sizeof(SurfaceMaterial) == 128 && sizeof(SurfaceMap) == 48 && sizeof(Face) == 64);
static_assert(sizeof(FaceCorners) == 16 && sizeof(CornerAttributes) == 64);
#endif

SHARED_END

#include "shaders/shared/language_end.h"

#endif
