// Traces lines through points in the air and lists those that join the two sides of the cut.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/light_bindings.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= light.count) return;
  LineEnds line;
  uint fate = line_through(tries[i], light.first + i, line);
  lines[i] = line;
  fates[i] = min(fate, FATE_SAME_SIDE);
  if (fate == FATE_JOINS) list_to_vote(i);
}
