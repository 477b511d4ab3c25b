// Invocation i < n counts at texel i and in words[0], then changes words[1 + i].
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/language.h"
layout(local_size_x = 64) in;
layout(set = 0, binding = 0, r32ui) uniform uimage3D counts;
layout(set = 0, binding = 1, std430) buffer Words { uint words[]; };
layout(push_constant) uniform Push {
  uint n;
  uint step;
  float scale;
};

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= n) return;
  uvec3 size = uvec3(imageSize(counts));
  uvec3 texel = uvec3(i % size.x, i / size.x % size.y, i / size.x / size.y % size.z);
  imageAtomicAdd(counts, ivec3(texel), step);
  atomicAdd(words[0], step);
  float scaled = scale * float(words[1 + i]) + 0.5;
  words[1 + i] = uint(scaled);
}
