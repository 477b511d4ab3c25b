// Lists the ends of light walks for connections, cache by cache, with the data that estimates need
// [connection_estimates.h].
//
// Include after connect.h.

#include "shaders/shared/language.h"

/// Of a light vertex that can be connected.
SHARED void list_end(uint slot) MEMBER {
  PathDensity d = load_path_density(slot);
  if ((d.flags & VERTEX_THERE) == 0u || (d.flags & VERTEX_CONNECTIBLE) == 0u) return;
  PathVertex v = load_path_vertex(slot);
  ConnectionEnd end = connection_end(kept_point(slot, v), v.back, v.throughput, slot, number_of(d));
  connection_ends[scattered_ends() + load_end_first(v.walk) + v.ordinal] = end;
}
/// Of y_0 of a light walk.
SHARED void list_start(uint walk) MEMBER {
  PathVertex v = load_path_vertex(walk);
  PathDensity d = load_path_density(walk);
  if ((d.flags & VERTEX_THERE) == 0u) return;
  Point y0 = kept_point(walk, v);
  ConnectionEnd end = connection_end(y0, v.back, v.throughput, walk, 0u);
  // About what leaves it; the exact direction is evaluated once it is chosen.
  vec3 straight = at_infinity(y0) ? y0.position : y0.normal;
  end.carried = v.throughput * emitted(y0, straight);
  end.facing = v.facing;
  if (at_infinity(y0)) end.alpha2 = -1.0f;
  connection_ends[walk] = end;
}

#include "shaders/shared/language_end.h"
