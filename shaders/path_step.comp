// One step of a submission; which one the build says (tools/tdpt-render/device/machine.h).
#version 460
#extension GL_GOOGLE_include_directive : require

#include "shaders/shared/bvh.h"
#include "shaders/shared/path/film_units.h"
#include "shaders/shared/path/lights_layout.h"
#include "shaders/shared/path/portal_layout.h"
#include "shaders/shared/path/render_layout.h"
#include "shaders/shared/path/surface_heads.h"
#include "shaders/shared/path/joins.h"
#include "shaders/shared/scaled.h"
#include "shaders/shared/triangle.h"

#include "shaders/path_bindings.glsl"

#include "shaders/shared/sequence.h"

#include "shaders/shared/path/surface.h"

#include "shaders/shared/traversal.h"

#include "shaders/shared/path/sky.h"

#include "shaders/shared/path/lights.h"

#include "shaders/shared/path/panels.h"

#include "shaders/shared/path/window_sky.h"

#include "shaders/shared/path/next_event.h"

#include "shaders/shared/path/portals.h"

#include "shaders/shared/path/guide.h"

#include "shaders/shared/path/film_sum.h"

#include "shaders/shared/path/film.h"

#include "shaders/shared/path/camera.h"

#include "shaders/shared/path/samples.h"

#include "shaders/shared/path/rays.h"

#include "shaders/shared/path/weight.h"

#include "shaders/shared/path/walk.h"

#include "shaders/shared/path/connect.h"

#include "shaders/shared/path/segments.h"

#include "shaders/shared/path/kernels.h"

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= work.count) return;
#if defined BEGIN_LIGHT
  step_begin_light_walk(i);
#elif defined BEGIN_CAMERA
  step_begin_camera_walk(i);
#elif defined GO_ON_LIGHT
  step_go_on(FROM_LIGHT, i);
#elif defined GO_ON_CAMERA
  step_go_on(FROM_CAMERA, i);
#elif defined LIST_ENDS
  step_list_end(i);
#elif defined LIST_STARTS
  step_list_start(i);
#elif defined DRAW_SEGMENTS
  draw_segment(i);
#elif defined CONNECT
  connect_camera_vertex(work.first + i);
#elif defined SPLAT
  splat(work.first + i);
#elif defined SEE_SEGMENTS
  see_segment(i);
#elif defined JOIN_SEGMENTS
  join_few_segments(i);
#elif defined FLAG_LIGHT
  flags[i] = may_go_on(FROM_LIGHT, path_densities[work.first + i]) ? 1u : 0u;
#elif defined FLAG_CAMERA
  flags[i] = may_go_on(FROM_CAMERA, path_densities[work.first + i]) ? 1u : 0u;
#elif defined GATHER
  if (flags[i] != 0u) alive[ranks[i]] = work.first + i;
#endif
}
