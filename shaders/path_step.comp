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

#include "shaders/shared/path/joinings.h"

#include "shaders/shared/path/segments.h"

#include "shaders/shared/path/ends.h"

void main() {
  read_settings();
  uint i = gl_GlobalInvocationID.x;
  if (i >= work.count) return;
  uint slot = work.first + i;
#if defined BEGIN_LIGHT_WALKS
  begin_light_walk(i, slot);
#elif defined BEGIN_CAMERA_WALKS
  begin_camera_walk(i);
#elif defined GO_ON_LIGHT
  go_on(FROM_LIGHT, load_alive(i), i);
#elif defined GO_ON_CAMERA
  go_on(FROM_CAMERA, load_alive(i), i);
#elif defined TRACE
  trace_ray(i);
#elif defined ARRIVE_LIGHT
  arrive(FROM_LIGHT, i, work.next + i);
#elif defined ARRIVE_CAMERA
  arrive(FROM_CAMERA, i, work.next + i);
#elif defined LIST_ENDS
  list_end(slot);
#elif defined LIST_STARTS
  list_start(i);
#elif defined MEET_LIGHTS
  meet_light(slot);
#elif defined BEGIN_SEGMENTS
  begin_segment(i);
#elif defined END_SEGMENTS
  end_segment(i);
#elif defined PUT_SEGMENTS
  put_segment_together(i);
#elif defined GATHER_SIDES
  gather_sides(slot, 2u * i);
#elif defined FLAG_LIT
  flag_lit(slot, i);
#elif defined LIST_LIT
  list_lit(i);
#elif defined ESTIMATE_SEGMENTS
  estimate_segments(slot, i);
#elif defined CHOOSE_NEXT_EVENTS
  choose_next_event(slot, i);
#elif defined CHOOSE_JOINS
  choose_joins(slot, 2u * i);
#elif defined CHOOSE_SPLATS
  choose_splat(slot, i);
#elif defined CHOOSE_SIDES
  choose_sides(slot, 2u * i);
#elif defined CHOOSE_SEEN
  choose_seen(slot, i);
#elif defined CHOOSE_SEGMENTS
  choose_segments(slot, 3u * i, work.next);
#elif defined SCATTER_ENDS
  scatter_end(load_alive(i), work.first == 0u);
#elif defined SEE
  see(load_alive(i));
#elif defined JOIN
  join(load_alive(i));
#elif defined JOIN_SIDES
  join_side(load_alive(i));
#elif defined JOIN_SEGMENTS
  join_segment(load_alive(i));
#elif defined FLAG_LIGHT
  flags[i] = goes_on(FROM_LIGHT, slot) ? 1u : 0u;
#elif defined FLAG_CAMERA
  flags[i] = goes_on(FROM_CAMERA, slot) ? 1u : 0u;
#elif defined GATHER
  if (flags[i] != 0u) alive[load_rank(i)] = slot;
#endif
}
