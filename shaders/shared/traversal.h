// Traces rays and segments through the bounding volume hierarchy of bvh.h, without recursion.
//
// Include it where the arrays are: at global scope in GLSL, after the buffers, and INSIDE the body
// of a C++ struct whose members they are (libcommon/testing/scalar_tracer.h). Hence there is no
// include guard and no namespace; the C++ struct lies in tdpt::shader. The scope must provide:
//   load_bvh_node(i), load_bvh_triangle(i)
//   bool surface_stops(uint triangle, float b1, float b2, uint coin, vec3 w)
//       whether a surface that is not fully opaque stops this ray at this point. `coin` is the
//       ray's own random number, `w` its direction, of any length. Called only for triangles whose
//       `stops` is 0.
//
// Why no box is missed. Rays begin within 3 extents of the centre (ray_of) or miss the scene, so
// differences to corners are below 4 on a side axis and little above 2 on the main one, in extents.
// With e = 2^-24: the point of a corner (bvh.h) has an error below e (4 + 2 + 2 + 6) = 14 e,
// the point where the ray meets a slab, with a reciprocal good to 4 e, e 4 (1 + 4 + 1) = 24 e. The
// builder enlarges boxes by 2^-18 = 64 e extents on all sides. 0 * infinity never occurs: slopes
// are at least 1e-18.
//
// The answer does not depend on the order of the nodes: a hit counts as no nearer than the box of
// its leaf, boxes lie in the boxes of their parents and rounding is monotonic. So no box that is
// skipped can hold the nearest hit.

#include "shaders/shared/bvh.h"

#include "shaders/shared/language.h"

/// Depths at which the ray enters and leaves the box. Missed if near > far; behind the origin if
/// far < 0.
SHARED void box_depths(vec3 low, vec3 high, vec3 origin, vec3 per_slope, OUT(float) near,
                       OUT(float) far) MEMBER_CONST {
  vec3 a = (low - origin) * per_slope;
  vec3 b = (high - origin) * per_slope;
  near = max(max(min(a.x, b.x), min(a.y, b.y)), min(a.z, b.z));
  far = min(min(max(a.x, b.x), max(a.y, b.y)), max(a.z, b.z));
}

// Bottom of the stack: an empty leaf that ends the traversal.
const uint kBvhDone = 0x8FFFFFFFu;

/// Tests the triangles of a leaf whose box the ray enters at depth `near`; `best`: depth of `hit`.
SHARED void meet_leaf(uint leaf, float near, AxisRay ray, vec3 direction, uint coin,
                      INOUT(float) best, INOUT(SurfaceHit) hit) MEMBER_CONST {
  uint first = leaf & kBvhFirstMask;
  uint end = first + ((leaf >> kBvhCountShift) & kBvhCountMask);
  for (uint i = first; i < end; ++i) {
    BvhTriangle t = load_bvh_triangle(i);
    float depth, b1, b2;
    uint back;
    if (line_meets(ray, t.p0, t.p1, t.p2, depth, b1, b2, back) && depth > 1e-30f) {
      depth = max(depth, near);
      uint triangle = t.triangle;
      if ((depth < best || (depth == best && triangle < hit.triangle)) &&
          (t.stops != 0u || surface_stops(triangle, b1, b2, coin, direction))) {
        best = depth;
        hit.triangle = triangle;
        hit.b1 = b1;
        hit.b2 = b2;
        hit.back = back;
      }
    }
  }
}

/// The first surface at t > 0 along `direction`, which may have any length. Of several at the same
/// point, the triangle with the smallest index wins.
SHARED bool first_hit(vec3 origin, vec3 direction, uint coin, OUT(SurfaceHit) hit) MEMBER_CONST {
  hit.t = 0.0f;
  hit.triangle = 0xFFFFFFFFu;
  hit.b1 = 0.0f;
  hit.b2 = 0.0f;
  hit.back = 0u;
  AxisRay ray;
  if (!ray_of(origin, direction, load_bvh_node(0u).extent, ray)) return false;
  vec3 per_slope = vec3(reciprocal(ray.slope.x), reciprocal(ray.slope.y), reciprocal(ray.slope.z));
  float best = 3e38f;
  uint stack[kBvhStack + 1u];
  float stack_near[kBvhStack + 1u];
  stack[0] = kBvhDone;
  stack_near[0] = -1.0f;
  uint top = 1u;
  uint node = 0u;
  float node_near = 0.0f;
  // Descend to a leaf, then test it: rays that run in lockstep wait for each other only once per
  // leaf.
  while (true) {
    while ((node & kBvhLeaf) == 0u) {
      BvhNode here = load_bvh_node(node);
      float near0, far0, near1, far1;
      box_depths(here.low0, here.high0, ray.origin, per_slope, near0, far0);
      box_depths(here.low1, here.high1, ray.origin, per_slope, near1, far1);
      bool hit0 = near0 <= min(far0, best) && far0 >= 0.0f;
      bool hit1 = near1 <= min(far1, best) && far1 >= 0.0f;
      // Branch-free: the deferred child is always written.
      bool second = hit1 && (!hit0 || near1 < near0);
      stack[top] = second ? here.child0 : here.child1;
      stack_near[top] = second ? near0 : near1;
      top += hit0 && hit1 ? 1u : 0u;
      node = second ? here.child1 : here.child0;
      node_near = second ? near1 : near0;
      bool pops = !(hit0 || hit1);
      while (pops) {
        --top;
        node = stack[top];
        node_near = stack_near[top];
        pops = node_near > best;
      }
    }
    if (node == kBvhDone) break;
    meet_leaf(node, node_near, ray, direction, coin, best, hit);
    do {
      --top;
      node = stack[top];
      node_near = stack_near[top];
    } while (node_near > best);
  }
  if (hit.triangle == 0xFFFFFFFFu) return false;
  hit.t = (ray.start + best) * ray.per_depth;
  return true;
}

/// Whether a surface lies strictly between `a` and `b`; never between a point and itself. Depths
/// are rounded: ends on surfaces must be offset from them, as ray origins are, by about 2^-21
/// (tracer.h).
SHARED bool segment_blocked(vec3 a, vec3 b, uint coin) MEMBER_CONST {
  vec3 direction = b - a;
  AxisRay ray;
  if (!ray_of(a, direction, load_bvh_node(0u).extent, ray)) return false;
  vec3 per_slope = vec3(reciprocal(ray.slope.x), reciprocal(ray.slope.y), reciprocal(ray.slope.z));
  float limit = ray.size - ray.start;
  uint stack[kBvhStack + 1u];
  stack[0] = kBvhDone;
  uint top = 1u;
  uint node = 0u;
  bool blocked = false;
  while (!blocked) {
    while ((node & kBvhLeaf) == 0u) {
      BvhNode here = load_bvh_node(node);
      float near0, far0, near1, far1;
      box_depths(here.low0, here.high0, ray.origin, per_slope, near0, far0);
      box_depths(here.low1, here.high1, ray.origin, per_slope, near1, far1);
      bool hit0 = near0 <= min(far0, limit) && far0 >= 0.0f;
      bool hit1 = near1 <= min(far1, limit) && far1 >= 0.0f;
      // Any hit will do: visit first the box in which the segment is longer, since a hit is
      // likelier there.
      float way0 = min(far0, limit) - max(near0, 0.0f);
      float way1 = min(far1, limit) - max(near1, 0.0f);
      bool second = hit1 && (!hit0 || way1 > way0);
      stack[top] = second ? here.child0 : here.child1;
      top += hit0 && hit1 ? 1u : 0u;
      node = second ? here.child1 : here.child0;
      if (!(hit0 || hit1)) {
        --top;
        node = stack[top];
      }
    }
    if (node == kBvhDone) break;
    uint first = node & kBvhFirstMask;
    uint end = first + ((node >> kBvhCountShift) & kBvhCountMask);
    for (uint i = first; i < end && !blocked; ++i) {
      BvhTriangle t = load_bvh_triangle(i);
      float depth, b1, b2;
      uint back;
      if (line_meets(ray, t.p0, t.p1, t.p2, depth, b1, b2, back) && depth > 1e-30f && depth < limit)
        blocked = t.stops != 0u || surface_stops(t.triangle, b1, b2, coin, direction);
    }
    --top;
    node = stack[top];
  }
  return blocked;
}

#include "shaders/shared/language_end.h"
