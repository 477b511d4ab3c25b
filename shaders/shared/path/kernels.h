// What invocation i of each step does, for kernels and their twin.
//
// Read behind all other texts of this folder, where alive[] and `work`, the parameters of the step,
// are.

#include "shaders/shared/language.h"

SHARED void step_begin_light_walk(uint i) MEMBER {
  if (i == 0u) walk_counts[work.count] = 0u;  // their sum will be there
  begin_light_walk(i, work.first + i, work.next + i);
}
SHARED void step_begin_camera_walk(uint i) MEMBER {
  begin_camera_walk(i, work.next + i);
}
SHARED void step_go_on(uint from, uint i) MEMBER {
  go_on(from, alive[i], work.next + i);
}

/// Of a light's vertex that can be joined.
SHARED void step_list_end(uint i) MEMBER {
  uint slot = work.first + i;
  PathDensity d = path_densities[slot];
  if ((d.flags & VERTEX_THERE) == 0u || (d.flags & VERTEX_CONNECTIBLE) == 0u) return;
  PathVertex v = path_vertices[slot];
  JoinEnd end = join_end(point_of(v), v.back, v.throughput, slot, number_of(d));
  join_ends[scattered_ends() + end_first[v.walk] + v.ordinal] = end;
}
/// Of y_0 of light walk work.first + i.
SHARED void step_list_start(uint i) MEMBER {
  uint walk = work.first + i;
  PathVertex v = path_vertices[walk];
  PathDensity d = path_densities[walk];
  if ((d.flags & VERTEX_THERE) == 0u) return;
  Point y0 = point_of(v);
  JoinEnd end = join_end(y0, v.back, v.throughput, walk, 0u);
  // About what leaves it; which way is for those that are taken.
  vec3 straight = at_infinity(y0) ? y0.position : y0.normal;
  end.carried = v.throughput * emitted(y0, straight);
  end.facing = v.facing;
  if (at_infinity(y0)) end.alpha2 = -1.0f;
  join_ends[walk] = end;
}

#include "shaders/shared/language_end.h"
