// Traces lines through places in the air and lists those that join the sides of the cut.
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
  uint i = gl_GlobalInvocationID.x;
  if (i >= light.count) return;
  LineEnds line;
  uint fate = line_through(tries[i], light.first + i, line);
  lines[i] = line;
  fates[i] = min(fate, FATE_SAME_SIDE);
  if (fate == FATE_JOINS) list_to_vote(i);
}
