// Rays and segments through the hierarchy of bvh.h, without recursion.
//
// Included where the arrays are: at global scope in GLSL, behind the buffers, and INSIDE a struct's
// body in C++, whose members they are (libcommon/trace/scalar_tracer.h). Hence no include guard, no
// namespace and no other includes here: bvh.h and triangle.h come before, and the C++ struct lies
// in tdpt::shader. What must be there:
//   bvh_nodes[], bvh_triangles[]
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

#include "shaders/shared/language.h"

/// Where the ray is in the box, as depths. Missed when near > far; behind its origin when far < 0.
SHARED void box_depths(vec3 low, vec3 high, vec3 origin, vec3 per_slope, OUT(float) near,
                       OUT(float) far) MEMBER_CONST {
  vec3 a = (low - origin) * per_slope;
  vec3 b = (high - origin) * per_slope;
  near = max(max(min(a.x, b.x), min(a.y, b.y)), min(a.z, b.z));
  far = min(min(max(a.x, b.x), max(a.y, b.y)), max(a.z, b.z));
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
  if (!ray_of(origin, direction, bvh_nodes[0].extent, ray)) return false;
  vec3 per_slope = vec3(reciprocal(ray.slope.x), reciprocal(ray.slope.y), reciprocal(ray.slope.z));
  float best = 3e38f;
  uint stack[kBvhStack];
  float stack_near[kBvhStack];
  uint top = 0u;
  uint node = 0u;
  float node_near = 0.0f;
  while (true) {
    bool descended = false;
    if ((node & kBvhLeaf) == 0u) {
      uint child0 = bvh_nodes[node].child0;
      uint child1 = bvh_nodes[node].child1;
      float near0, far0, near1, far1;
      box_depths(bvh_nodes[node].low0, bvh_nodes[node].high0, ray.origin, per_slope, near0, far0);
      box_depths(bvh_nodes[node].low1, bvh_nodes[node].high1, ray.origin, per_slope, near1, far1);
      bool hit0 = near0 <= min(far0, best) && far0 >= 0.0f;
      bool hit1 = near1 <= min(far1, best) && far1 >= 0.0f;
      // Without branches: the child that waits is written at any rate.
      bool second = hit1 && (!hit0 || near1 < near0);
      stack[top] = second ? child0 : child1;
      stack_near[top] = second ? near0 : near1;
      top += hit0 && hit1 ? 1u : 0u;
      node = second ? child1 : child0;
      node_near = second ? near1 : near0;
      descended = hit0 || hit1;
    } else {
      uint first = node & kBvhFirstMask;
      uint end = first + ((node >> kBvhCountShift) & kBvhCountMask);
      for (uint i = first; i < end; ++i) {
        float depth, b1, b2;
        uint back;
        if (line_meets(ray, bvh_triangles[i].p0, bvh_triangles[i].p1, bvh_triangles[i].p2, depth,
                       b1, b2, back) &&
            depth > 1e-30f) {
          depth = max(depth, node_near);
          uint triangle = bvh_triangles[i].triangle;
          if ((depth < best || (depth == best && triangle < hit.triangle)) &&
              (bvh_triangles[i].stops != 0u || surface_stops(triangle, b1, b2, coin, direction))) {
            best = depth;
            hit.triangle = triangle;
            hit.b1 = b1;
            hit.b2 = b2;
            hit.back = back;
          }
        }
      }
    }
    while (!descended && top > 0u) {
      --top;
      node = stack[top];
      node_near = stack_near[top];
      descended = node_near <= best;
    }
    if (!descended) break;
  }
  if (hit.triangle == 0xFFFFFFFFu) return false;
  float t = (ray.start + best) * ray.per_depth;
  hit.t = t;
  return true;
}

/// Whether a surface lies strictly between `a` and `b`. Nothing lies between a place and itself.
/// Depths are rounded: ends that lie on surfaces are to be stepped off them, as the origins of rays
/// are, by some 2^-21 (tracer.h).
SHARED bool segment_blocked(vec3 a, vec3 b, uint coin) MEMBER_CONST {
  vec3 direction = b - a;
  AxisRay ray;
  if (!ray_of(a, direction, bvh_nodes[0].extent, ray)) return false;
  vec3 per_slope = vec3(reciprocal(ray.slope.x), reciprocal(ray.slope.y), reciprocal(ray.slope.z));
  float limit = ray.size - ray.start;
  uint stack[kBvhStack];
  uint top = 0u;
  uint node = 0u;
  while (true) {
    bool descended = false;
    if ((node & kBvhLeaf) == 0u) {
      uint child0 = bvh_nodes[node].child0;
      uint child1 = bvh_nodes[node].child1;
      float near0, far0, near1, far1;
      box_depths(bvh_nodes[node].low0, bvh_nodes[node].high0, ray.origin, per_slope, near0, far0);
      box_depths(bvh_nodes[node].low1, bvh_nodes[node].high1, ray.origin, per_slope, near1, far1);
      bool hit0 = near0 <= min(far0, limit) && far0 >= 0.0f;
      bool hit1 = near1 <= min(far1, limit) && far1 >= 0.0f;
      // Any surface will do: where the segment is in the box for longer, it is likelier to meet
      // one.
      float way0 = min(far0, limit) - max(near0, 0.0f);
      float way1 = min(far1, limit) - max(near1, 0.0f);
      bool second = hit1 && (!hit0 || way1 > way0);
      stack[top] = second ? child0 : child1;
      top += hit0 && hit1 ? 1u : 0u;
      node = second ? child1 : child0;
      descended = hit0 || hit1;
    } else {
      uint first = node & kBvhFirstMask;
      uint end = first + ((node >> kBvhCountShift) & kBvhCountMask);
      for (uint i = first; i < end; ++i) {
        float depth, b1, b2;
        uint back;
        if (line_meets(ray, bvh_triangles[i].p0, bvh_triangles[i].p1, bvh_triangles[i].p2, depth,
                       b1, b2, back) &&
            depth > 1e-30f && depth < limit &&
            (bvh_triangles[i].stops != 0u ||
             surface_stops(bvh_triangles[i].triangle, b1, b2, coin, direction)))
          return true;
      }
    }
    if (!descended) {
      if (top == 0u) return false;
      --top;
      node = stack[top];
    }
  }
  return false;
}

#include "shaders/shared/language_end.h"
