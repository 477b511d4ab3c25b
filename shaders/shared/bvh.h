// Layout of the bounding volume hierarchy that traversal.h walks: std430 in GLSL, the same bytes in
// C++. libcommon/trace/bvh.h builds it.
#ifndef TDPT_SHADERS_SHARED_BVH_H
#define TDPT_SHADERS_SHARED_BVH_H

#include "shaders/shared/records.h"

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
RECORD_ALIGNED(CACHE_LINE, BvhNode)

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

SHARED_END

#include "shaders/shared/language_end.h"

#endif
