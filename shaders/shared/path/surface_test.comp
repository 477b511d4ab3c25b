// Test only: the words of surface_test.h, one point per invocation.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/shared/path/tables.h"
#include "shaders/shared/path/words_test.h"
#include "shaders/shared/tables.h"

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Faces { Face faces[]; };
layout(std430, binding = 1) readonly buffer CornersOfFaces { FaceCorners face_corners[]; };
layout(std430, binding = 2) readonly buffer Attributes { CornerAttributes corner_attributes[]; };
layout(std430, binding = 3) readonly buffer Materials { SurfaceMaterial materials[]; };
layout(std430, binding = 4) readonly buffer Maps { SurfaceMap texture_maps[]; };
layout(std430, binding = 5) readonly buffer Texels { uint texel_words[]; };
layout(std430, binding = 6) readonly buffer Curves { float surface_curves[]; };
layout(std430, binding = 7) readonly buffer CoverageOf { uint coverage_of[]; };
layout(std430, binding = 8) readonly buffer Coverages { Coverage coverages[]; };
layout(std430, binding = 9) readonly buffer MapsOfMaterials { uint material_maps[]; };
layout(std430, binding = 10) writeonly buffer Words { uint words[]; };
layout(std430, binding = 11) readonly buffer SheenCurves { float sheen_curves[]; };
layout(push_constant) uniform Parameters { uint triangles; };

const bool scene_has_layers = true;
const bool scene_has_normals = true;
const bool scene_has_textures = true;
const bool scene_has_colours = true;
const bool scene_has_coats = true;
const bool scene_has_sheen = true;
const bool scene_has_transmission = true;
const bool scene_has_absorption = true;
const bool scene_has_panes = true;
const bool scene_has_coverage = true;
const bool coverage_has_textures = true;

TABLES_OF_SURFACES(LOADS)
#include "shaders/shared/path/surface.h"

#include "shaders/shared/path/surface_test.h"

void main() {
  uint i = gl_GlobalInvocationID.x;
  PlaceWords place = words_of_place(i, triangles);
  for (uint k = 0u; k < kWordsOfPlace; ++k) words[i * kWordsOfPlace + k] = place.words[k];
}
