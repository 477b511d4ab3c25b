// Rays and segments through the hierarchy of bvh.h, without recursion.
//
// Included where the arrays are: at global scope in GLSL, behind the buffers, and INSIDE a struct's
// body in C++, whose members they are (libcommon/trace/scalar_tracer.h). Hence no include guard and
// no namespace here: the C++ struct lies in tdpt::shader. What must be there:
//   load_bvh_node(i), load_bvh_triangle(i)
//   bool surface_stops(uint triangle, float b1, float b2, uint coin, vec3 w)
//       whether a surface that is there with some probability is there for this ray at this place.
//       `coin` is the ray's own number, `w` its direction, of any length. Asked of triangles whose
//       `stops` is 0 only.
//
// Why no box is missed. Rays begin within 3 extents of the middle (ray_of) or miss the scene, so
// differences to corners are below 4 on a side axis and little above 2 on the main one, in extents.
// With e = 2^-24: the point of a corner (triangle.h) is off by less than e (4 + 2 + 2 + 6) = 14 e,
// the ray's place where it meets a slab, with a reciprocal good to 4 e, by e 4 (1 + 4 + 1) = 24 e.
// The builder makes boxes larger by 2^-18 = 64 e extents on all sides. Nowhere is 0 * infinity:
// slopes are at least 1e-18.
//
// The answer does not depend on the order of the nodes: a hit counts as no nearer than the box of
// its leaf, boxes lie in the boxes of their parents and rounding is monotonic, so that no box that
// is left out can hold the winner.

#include "shaders/shared/bvh.h"
#include "shaders/shared/triangle.h"

#include "shaders/shared/language.h"

/// Where the ray is in the box, as depths. Missed when near > far; behind its origin when far < 0.
SHARED void box_depths(vec3 low, vec3 high, vec3 origin, vec3 per_slope, OUT(float) near,
                       OUT(float) far) MEMBER_CONST {
  vec3 a = (low - origin) * per_slope;
  vec3 b = (high - origin) * per_slope;
  near = max(max(min(a.x, b.x), min(a.y, b.y)), min(a.z, b.z));
  far = min(min(max(a.x, b.x), max(a.y, b.y)), max(a.z, b.z));
}

// Waits below all that a traversal has put aside: a leaf that is not there.
const uint kBvhDone = 0x8FFFFFFFu;

/// The triangles of a leaf whose box the ray enters at depth `near`; `best`: of `hit`.
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
/// place the triangle with the smallest index.
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
  // First down to a leaf, then through it: of rays that go side by side each waits for the others
  // once a leaf.
  while (true) {
    while ((node & kBvhLeaf) == 0u) {
      BvhNode here = load_bvh_node(node);
      float near0, far0, near1, far1;
      box_depths(here.low0, here.high0, ray.origin, per_slope, near0, far0);
      box_depths(here.low1, here.high1, ray.origin, per_slope, near1, far1);
      bool hit0 = near0 <= min(far0, best) && far0 >= 0.0f;
      bool hit1 = near1 <= min(far1, best) && far1 >= 0.0f;
      // Without branches: the child that waits is written at any rate.
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

/// Whether a surface lies strictly between `a` and `b`. Nothing lies between a place and itself.
/// Depths are rounded: ends that lie on surfaces are to be stepped off them, as the origins of rays
/// are, by some 2^-21 (tracer.h).
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
      // Any surface will do: where the segment is in the box for longer, it is likelier to meet
      // one.
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
