// Test only: the words of numbers_test.h, one run per invocation.
#version 460
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Points { uvec4 sobol_points[]; };
layout(std430, binding = 1) writeonly buffer Words { uint words[]; };
uvec4 load_sobol_point(uint i) { return sobol_points[i]; }
#include "shaders/shared/numbers_test.h"

void main() {
  Numbers drawn = draw_numbers(gl_GlobalInvocationID.x);
  for (uint k = 0u; k < kNumbersOfOne; ++k)
    words[gl_GlobalInvocationID.x * kNumbersOfOne + k] = drawn.words[k];
}
