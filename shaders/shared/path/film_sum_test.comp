// Test only: many invocations add to a few sums.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/rng.h"
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Film { uint film_words[]; };
layout(std430, binding = 1) writeonly buffer Held { uint held[]; };
#include "shaders/shared/path/film_sum.h"

#include "shaders/shared/path/film_sum_test.h"

void main() {
  uint i = gl_GlobalInvocationID.x;
  held[i] = film_trial(i) ? 1u : 0u;
}
