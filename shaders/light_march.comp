// Counts the listed lines in the voxels that they pass.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/shared/bvh.h"
#include "shaders/shared/grid_walk.h"
#include "shaders/shared/light_layout.h"
#include "shaders/shared/rng.h"
#include "shaders/shared/texels.h"
#include "shaders/shared/triangle.h"
#include "shaders/shared/warp.h"

#include "shaders/light_bindings.glsl"

#include "shaders/shared/coverage.h"

#include "shaders/shared/traversal.h"

#include "shaders/shared/light_lines.h"

void main() {
  uint n = gl_GlobalInvocationID.x;
  if (n < to_march.count) march(lines[listed[light.count + n]]);
}
