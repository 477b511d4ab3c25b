// Whether the ends of the listed lines see their own sides of the cut; lists those whose ends do.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/light_bindings.glsl"

void main() {
  uint n = gl_GlobalInvocationID.x;
  if (n >= to_vote.count) return;
  uint i = listed[n];
  if (!ends_see_their_sides(lines[i], light.first + i)) return;
  fates[i] = FATE_JOINS;
  list_to_march(i);
}
