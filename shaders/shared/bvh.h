// Layouts of the bounding volume hierarchy that traversal.h walks: std430 in GLSL, the same bytes
// in C++. libcommon/trace/bvh.h builds it.
#ifndef TDPT_SHADERS_SHARED_BVH_H
#define TDPT_SHADERS_SHARED_BVH_H

#include "shaders/shared/language.h"

SHARED_BEGIN

/// Entries that a traversal may have to put aside: no leaf lies deeper below node 0 than this.
const uint kBvhStack = 48u;

/// An inner node with the boxes of both its children. A child is the index of an inner node, or a
/// leaf: bit 31 set, the number of its triangles in bits 28 to 30 (0: an empty leaf), the index of
/// the first one in bits 0 to 27. Node 0 is the root and always there.
struct CACHE_LINE BvhNode {
  vec3 low0;
  uint child0;
  vec3 high0;
  uint child1;
  vec3 low1;
  float extent;  ///< of node 0: no coordinate of a triangle exceeds it. 0 in all others
  vec3 high1;
  uint pad;
};

const uint kBvhLeaf = 0x80000000u;
const uint kBvhFirstMask = 0x0FFFFFFFu;
const uint kBvhCountShift = 28u;
const uint kBvhCountMask = 7u;

struct BvhTriangle {
  vec3 p0;
  uint triangle;  ///< index in Scene::triangles
  vec3 p1;
  uint stops;  ///< 1: stops every ray; 0: surface_stops() is asked
  vec3 p2;
  uint pad;
};

struct SurfaceHit {
  float t;        ///< in units of the ray's direction, above 0
  uint triangle;  ///< index in Scene::triangles
  float b1, b2;   ///< barycentrics of p1 and p2
  uint back;      ///< 1: the side met is not the counter-clockwise front
};

#ifdef __cplusplus
static_assert(sizeof(BvhNode) == 64 && sizeof(BvhTriangle) == 48 && sizeof(SurfaceHit) == 20);
#endif

SHARED_END

#include "shaders/shared/language_end.h"

#endif
