// Counts the listed lines in the voxels that they pass through.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/light_bindings.glsl"

void main() {
  uint n = gl_GlobalInvocationID.x;
  if (n < to_march.count) march(lines[listed[light.count + n]]);
}
