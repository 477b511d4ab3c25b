// One step of a submission; the build defines which (shaders/shared/path/steps.def).
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/path_bindings.glsl"

#include "shaders/shared/path/kernels.h"

void main() {
  read_settings();
  uint i = gl_GlobalInvocationID.x;
  if (i >= work.count) return;
  uint slot = work.first + i;
  STEP;
}
