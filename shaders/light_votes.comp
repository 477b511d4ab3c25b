// Tests whether both ends of each listed line see mostly their own side of the cut, and lists the
// lines that pass.
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
