// Draws segments between pivot patches and lists those that are free.
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
  LineEnds line = draw_line(light.first + i);
  bool free = line_is_free(line, light.first + i);
  lines[i] = line;
  fates[i] = free ? FATE_SAME_SIDE : FATE_NONE;
  if (free) list_to_vote(i);
}
