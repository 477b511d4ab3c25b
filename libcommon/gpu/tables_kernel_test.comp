// Invocation i < 4 adds word i of a table, times a factor, to words[i].
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/language.h"
layout(local_size_x = 64) in;
layout(binding = 0) uniform usamplerBuffer texels;
layout(std140, binding = 1) uniform Settings {
  uint factor;
  uvec4 first_texels;
};
layout(std430, binding = 2) buffer Words { uint words[]; };
layout(push_constant) uniform Push { uint table; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= 4) return;
  words[i] += factor * texelFetch(texels, int(first_texels[table]))[i];
}
