// The bounding volume hierarchy that traversal.h walks (its layout is std430 in GLSL, the same
// bytes in C++; libcommon/trace/bvh.h builds it), and the intersection of a ray and a triangle.
#ifndef TDPT_SHADERS_SHARED_BVH_H
#define TDPT_SHADERS_SHARED_BVH_H

#include "shaders/shared/records.h"
#include "shaders/shared/vector.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// Maximum number of stack entries of a traversal: no leaf lies deeper below node 0 than this.
const uint kBvhStack = 48u;

/// An inner node with the boxes of both its children. A child is either the index of an inner node
/// or a leaf: bit 31 set, the number of its triangles in bits 28 to 30 (0: an empty leaf), the
/// index of the first one in bits 0 to 27. Node 0 is the root and always exists.
#define TEXELS_OF_BvhNode(VEC, WORDS, PART)                                                   \
  VEC(low0, uint, child0)                                                                     \
  VEC(high0, uint, child1)                                                                    \
  /* extent: in node 0, the largest absolute coordinate of all triangles; 0 in other nodes */ \
  VEC(low1, float, extent)                                                                    \
  VEC(high1, uint, pad)
RECORD(BvhNode)

const uint kBvhLeaf = 0x80000000u;
const uint kBvhFirstMask = 0x0FFFFFFFu;
const uint kBvhCountShift = 28u;
const uint kBvhCountMask = 7u;

#define TEXELS_OF_BvhTriangle(VEC, WORDS, PART)               \
  /* triangle: index in Scene::triangles */                   \
  VEC(p0, uint, triangle)                                     \
  /* stops: 1: stops every ray; 0: surface_stops() decides */ \
  VEC(p1, uint, stops)                                        \
  VEC(p2, uint, pad)
RECORD(BvhTriangle)

struct SurfaceHit {
  float t;        ///< in units of the ray's direction, above 0
  uint triangle;  ///< index in Scene::triangles
  float b1, b2;   ///< barycentrics of p1 and p2
  uint back;      ///< 1: hit on the back, not on the counter-clockwise front
};

#ifdef __cplusplus
static_assert(sizeof(BvhNode) == 64 && sizeof(BvhTriangle) == 48 && sizeof(SurfaceHit) == 20);
#endif

// Watertight intersection of rays and triangles (Woop, Benthin and Wald, "Watertight ray/triangle
// intersection", 2013) with exact signs.
//
// Seen along the ray, the three corners are points (x, y) of a plane and the ray is its origin. A
// corner's point depends on the ray and the corner alone, so triangles that share corners share
// points, whatever was rounded. The ray hits a triangle if the three edge functions x_i y_j - y_i
// x_j have no two opposite signs. Rounding is monotonic: if the two rounded products differ, their
// order is that of the exact ones; if they are equal, their rounding errors decide, which are
// floats themselves (Dekker). So the sign is that of the exact edge function, opposite for the two
// triangles at an edge, and an edge function of 0 counts for both: no ray passes between them.
//
// Points closer than 2^-38 to an axis are moved onto it, so that no product and no rounding error
// falls below 2^-122. Results therefore do not depend on whether a device keeps denormal numbers.

/// A ray described by its main axis, the one along which it is steepest. Depths are distances along
/// that axis in the ray's direction.
struct AxisRay {
  vec3 origin;
  vec3 slope;       ///< direction per depth: 1 or -1 on the main axis; magnitude at least 1e-18
  uint axis;        ///< the main axis
  float sign;       ///< slope on the main axis
  float start;      ///< depth of `origin` on the original ray, 0 or above
  float size;       ///< depth of the tip of its direction
  float per_depth;  ///< 1/size
};

SHARED float slope_along(float d, float per_depth) {
  float s = d * per_depth;
  return abs(s) >= 1e-18f ? s : (s < 0.0f ? -1e-18f : 1e-18f);
}

/// False for a direction of zero (below 1e-36). An origin in front of the scene's `extent` on the
/// main axis is moved up to it, less 2^-16 of the extent and 2^-20 of the distance, so that what
/// lies at `extent` still lies ahead: rounding then depends on the size of the scene and not on how
/// far outside of it the ray begins. `direction` at most 1e36.
SHARED bool ray_of(vec3 origin, vec3 direction, float extent, OUT(AxisRay) ray) {
  float x = abs(direction.x);
  float y = abs(direction.y);
  float z = abs(direction.z);
  uint axis = x >= y ? (x >= z ? 0u : 2u) : (y >= z ? 1u : 2u);
  float size = axis == 0u ? x : (axis == 1u ? y : z);
  float along = axis == 0u ? direction.x : (axis == 1u ? direction.y : direction.z);
  float place = axis == 0u ? origin.x : (axis == 1u ? origin.y : origin.z);
  float sign = along < 0.0f ? -1.0f : 1.0f;
  float per_depth = size >= 1e-36f ? reciprocal(size) : 1.0f;
  ray.slope = vec3(axis == 0u ? sign : slope_along(direction.x, per_depth),
                   axis == 1u ? sign : slope_along(direction.y, per_depth),
                   axis == 2u ? sign : slope_along(direction.z, per_depth));
  float way = -1.00001526f * extent - sign * place;
  float start = way > 0.0f ? way * 0.999999046f : 0.0f;
  vec3 moved = origin + ray.slope * start;
  ray.origin = start > 0.0f ? moved : origin;
  ray.axis = axis;
  ray.sign = sign;
  ray.start = start;
  ray.size = size;
  ray.per_depth = per_depth;
  return size >= 1e-36f;
}

/// `a` with the main axis last and the others in cyclic order.
SHARED vec3 axis_last(vec3 a, uint axis) {
  return axis == 0u ? vec3(a.y, a.z, a.x) : (axis == 1u ? vec3(a.z, a.x, a.y) : a);
}

/// A corner as seen along the ray: its point in the plane and its depth.
SHARED vec3 seen_along(AxisRay ray, vec3 slope, vec3 corner) {
  vec3 from_origin = corner - ray.origin;
  vec3 a = axis_last(from_origin, ray.axis);
  float depth = ray.sign * a.z;
  float x = a.x - slope.x * depth;
  float y = a.y - slope.y * depth;
  const float least = 3.6379788e-12f;  // 2^-38
  return vec3(abs(x) < least ? 0.0f : x, abs(y) < least ? 0.0f : y, depth);
}

/// a b - p, which is exactly a float if p is the rounded product (Dekker, Veltkamp).
SHARED float product_error(float a, float b, float p) {
  float ca = 4097.0f * a;
  float cb = 4097.0f * b;
  float ah = ca - (ca - a);
  float bh = cb - (cb - b);
  float al = a - ah;
  float bl = b - bh;
  float e = ((ah * bh - p) + ah * bl + al * bh) + al * bl;
  return e;
}

/// a.x b.y - a.y b.x, with the exact sign.
SHARED float edge_function(vec3 a, vec3 b) {
  float p = a.x * b.y;
  float q = a.y * b.x;
  float r = p - q;
  if (p == q) {
    float ep = product_error(a.x, b.y, p);
    float eq = product_error(a.y, b.x, q);
    r = ep - eq;
  }
  return r;
}

/// Improves `r` = edge_function(a, b) to two units in the last place. Otherwise the rounding of the
/// products would shift hit points along long thin triangles.
SHARED float refined_edge_function(vec3 a, vec3 b, float r) {
  float p = a.x * b.y;
  float q = a.y * b.x;
  float ep = product_error(a.x, b.y, p);
  float eq = product_error(a.y, b.x, q);
  float more = (p - q) + (ep - eq);
  return more == 0.0f ? r : more;
}

/// Whether the line of the ray meets the triangle, at any depth. Edge-on triangles are not hit;
/// their neighbours are.
SHARED bool line_meets(AxisRay ray, vec3 p0, vec3 p1, vec3 p2, OUT(float) depth, OUT(float) b1,
                       OUT(float) b2, OUT(uint) back) {
  vec3 slope = axis_last(ray.slope, ray.axis);
  vec3 a = seen_along(ray, slope, p0);
  vec3 b = seen_along(ray, slope, p1);
  vec3 c = seen_along(ray, slope, p2);
  depth = 0.0f;
  b1 = 0.0f;
  b2 = 0.0f;
  back = 0u;
  float u = edge_function(b, c);
  float v = edge_function(c, a);
  float w = edge_function(a, b);
  if ((u < 0.0f || v < 0.0f || w < 0.0f) && (u > 0.0f || v > 0.0f || w > 0.0f)) return false;
  if (u == 0.0f && v == 0.0f && w == 0.0f) return false;
  u = refined_edge_function(b, c, u);
  v = refined_edge_function(c, a, v);
  w = refined_edge_function(a, b, w);
  float det = u + v + w;
  float per_det = reciprocal(det);
  float s0 = u * per_det;
  float s1 = v * per_det;
  float s2 = w * per_det;
  float mean = s0 * a.z + s1 * b.z + s2 * c.z;
  // A weighted mean lies between the corners, also after rounding.
  depth = max(min(min(a.z, b.z), c.z), min(max(max(a.z, b.z), c.z), mean));
  b1 = s1 < 1e-30f ? 0.0f : s1;
  b2 = s2 < 1e-30f ? 0.0f : s2;
  // Seen from its front by an incoming ray a triangle is clockwise; the plane is mirrored if the
  // ray runs down its main axis.
  back = (det > 0.0f) == (ray.sign > 0.0f) ? 1u : 0u;
  return true;
}

/// Paths keep this far from the edges of triangles (canonical). Where walls meet, rounding may put
/// a hit beyond the neighbouring wall, or let a ray meet the inside of a wall before the outside of
/// its neighbour: both move by less than this.
const float kEdgeMargin = 1.90734863e-6f;
/// From this far before a hit its surroundings are looked at again: a ray at 1e-4 to a wall passes
/// it that much earlier than it meets the next one within rounding of their edge.
const float kEdgeReach = 9.765625e-4f;

/// Barycentrics `b`, moved off an edge that lies nearer than the margin; `own`: that of the corner
/// opposite to it, `along`: scalar products of the edge with all three, `length2`: with itself.
GENERIC VEC3 off_edge(VEC3 b, REAL own, VEC3 along, REAL length2, REAL twice_area) {
  REAL size = root(length2);
  REAL missing = kEdgeMargin - own * twice_area * reciprocal(size);
  return missing > 0.0f ? b + along * (missing * reciprocal(size * twice_area)) : b;
}

/// Moves a place of the triangle with the edges e1 = p1 - p0 and e2 = p2 - p0 off its edges.
/// Whether it lies so near to one that rounding may decide if a ray along unit w meets the triangle
/// or its neighbour there: the depth at which it meets a triangle edge-on is the least certain.
/// False if the triangle is too narrow.
GENERIC bool keep_off_edges(VEC3 e1, VEC3 e2, VEC3 w, INOUT(REAL) b1, INOUT(REAL) b2) {
  const float margin2 = 3.63797881e-12f;  // of kEdgeMargin
  // Edge i lies opposite to corner i; they run round the triangle.
  VEC3 e0 = e2 - e1;
  REAL l0 = dot(e0, e0);
  REAL l1 = dot(e2, e2);
  REAL l2 = dot(e1, e1);
  VEC3 n = cross(e1, e2);
  REAL area2 = dot(n, n);
  REAL longest2 = max(l0, max(l1, l2));
  VEC3 b = VEC3(1.0f - b1 - b2, b1, b2);
  REAL least = max(min(b.x, min(b.y, b.z)), REAL(0));
  REAL across = least * dot(n, w);
  if (across * across >= margin2 * longest2 || area2 < 64.0f * margin2 * longest2) return false;
  REAL twice_area = root(area2);
  REAL e01 = -dot(e0, e2);
  REAL e02 = dot(e0, e1);
  REAL e12 = -dot(e1, e2);
  b = off_edge(b, b.x, VEC3(l0, e01, e02), l0, twice_area);
  b = off_edge(b, b.y, VEC3(e01, l1, e12), l1, twice_area);
  b = off_edge(b, b.z, VEC3(e02, e12, l2), l2, twice_area);
  b1 = b.y;
  b2 = b.z;
  return true;
}

SHARED_END

#include "shaders/shared/language_end.h"

#endif
