// Draws segments between pivot patches and lists the unblocked ones.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/light_bindings.glsl"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= light.count) return;
  LineEnds line = draw_line(light.first + i);
  bool free = line_is_free(line, light.first + i);
  lines[i] = line;
  fates[i] = free ? FATE_SAME_SIDE : FATE_NONE;
  if (free) list_to_vote(i);
}
