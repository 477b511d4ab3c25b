// Invocation i takes i + 1 from texel (i, 0, 0).
#version 460
layout(local_size_x = 4) in;
layout(set = 0, binding = 0, r32i) uniform iimage3D counts;

void main() {
  int i = int(gl_GlobalInvocationID.x);
  imageAtomicAdd(counts, ivec3(i, 0, 0), -1 - i);
}
