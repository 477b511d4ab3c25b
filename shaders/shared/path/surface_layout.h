// What kernels know of surfaces: materials, the maps that textures are seen through, faces, what is
// told of their corners, and curves. std430 in GLSL, the same bytes in C++;
// libcommon/scene/surface_tables.h fills them. Canonical frame; radiance is over a power of two.
#ifndef TDPT_SHADERS_SHARED_PATH_SURFACE_LAYOUT_H
#define TDPT_SHADERS_SHARED_PATH_SURFACE_LAYOUT_H

#include "shaders/shared/coverage_layout.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

const uint kNoMap = 0xFFFFFFFFu;

/// tdpt::Material, but for its maps.
struct SurfaceMaterial {
  vec3 base_color;
  uint flags;  ///< MATERIAL_*
  vec3 emission;
  float roughness;
  vec3 specular_color;
  float specular;
  vec3 absorption;
  float ior;
  vec3 sheen_color;
  float sheen_roughness;
  float metallic;
  float transmission;
  float normal_scale;
  float coat_normal_scale;
  float coat;
  float coat_roughness;
  float pane_share;  ///< of what is not reflected, gets through; 0: no pane
  float pane_f0;
  float pane_f90;
  uint maps_of_normals;  ///< 1: it has some
  uint pad0;
  uint pad1;
};
// material_maps[MAPS_OF_MATERIAL material + MAP_*]: index into texture_maps[], or kNoMap; in the
// order in which they count.
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
#define MAPS_OF_FACTORS 10u  // those before multiply factors
#define MAP_NORMAL 10u
#define MAP_COAT_NORMAL 11u
#define MATERIAL_PLAIN 1u
#define MATERIAL_EMITS 2u
#define MATERIAL_DOUBLE_SIDED 4u
#define MATERIAL_SOLID 8u
#define MATERIAL_GLOSSY_MAP 16u
#define MATERIAL_ABSORBS 32u

/// tdpt::TextureMap.
struct SurfaceMap {
  TexelGrid grid;
  float u_of_u;  ///< u' = u_of_u u + u_of_v v + u_shift
  float u_of_v;
  float u_shift;
  uint uv_set;
  float v_of_u;
  float v_of_v;
  float v_shift;
  uint pad;
};

struct Face {
  vec3 p0;
  uint material;
  vec3 e1;        ///< p1 - p0
  uint smoothed;  ///< Scene::smooth
  vec3 e2;        ///< p2 - p0
  uint pad0;
  vec3 normal;  ///< unit, of the front
  uint pad1;
};

/// The corners of a face in corner_attributes[]. None where nothing is told of corners.
struct FaceCorners {
  uint a;
  uint b;
  uint c;
  uint pad;
};

struct CornerAttributes {
  vec3 normal;  ///< unit or 0
  float handedness;
  vec3 tangent;  ///< unit or 0
  float alpha;
  vec3 color;
  float pad;
  float u0;  ///< first set of texture coordinates
  float v0;
  float u1;  ///< second
  float v1;
};

// surface_curves[]: tables of tools/tdpt-render/path/{interface_albedo,sheen}.cpp, one after the
// other, light over bytes, and the nodes of a quadrature.
const uint kInterfaceCosines = 64u;  ///< nodes; two numbers each
const uint kInterfaceAlphas = 48u;   ///< rows
const uint kInterfaceAverages = 2u * kInterfaceCosines * kInterfaceAlphas;
const uint kSheenCosines = 40u;
const uint kSheenRoughnesses = 24u;
const uint kSheenUnscaled = kInterfaceAverages + 2u * kInterfaceAlphas;
const uint kSheenAlbedos = kSheenUnscaled + kSheenCosines * kSheenRoughnesses;
const uint kLinearOfSrgb = kSheenAlbedos + kSheenCosines * kSheenRoughnesses;
const uint kGauss = kLinearOfSrgb + 256u;  ///< nodes 1/2 +- x of [0,1], and weights
const uint kGaussNodes = 6u;
const uint kSurfaceCurves = kGauss + 2u * kGaussNodes;

#ifdef __cplusplus
static_assert(sizeof(SurfaceMaterial) == 128 && sizeof(SurfaceMap) == 48 && sizeof(Face) == 64);
static_assert(sizeof(FaceCorners) == 16 && sizeof(CornerAttributes) == 64);
#endif

SHARED_END

#include "shaders/shared/language_end.h"

#endif
