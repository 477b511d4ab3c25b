// Whether the ends of the listed lines see their own sides of the cut; lists those whose ends do.
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
  if (n >= to_vote.count) return;
  uint i = listed[n];
  if (!ends_see_their_sides(lines[i], light.first + i)) return;
  fates[i] = FATE_JOINS;
  list_to_march(i);
}
