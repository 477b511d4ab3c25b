// Portals in flat tables for portals.h; C++ also has them in doubles. Everything is canonical.
#ifndef TDPT_SHADERS_SHARED_PATH_PORTAL_LAYOUT_H
#define TDPT_SHADERS_SHARED_PATH_PORTAL_LAYOUT_H

#include "shaders/shared/path/point.h"
#include "shaders/shared/records.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// A portal counts only for segments that begin and end at least this far from its plane, 2^-18.
///
/// If a portal lies in a surface, rounding must not decide what crosses it. With e = 2^-24 and a
/// point at most 3.5 (the scene's size) from the centre of a facet, its height over the facet's
/// plane has an error of 0.9 e from the centre, 0.9 * 3.5 e from the normal, 3.5 e from the
/// difference and 3 * 3.5 e from the products: 18 e. A point on a surface has an error of 4 e, and
/// so have the corners that it was made from: in all 26 e. Half the margin is 32 e, so that a ray
/// which begins half a margin behind the plane begins behind any surface in it, and such a surface
/// is on neither side.
const float kPortalMargin = 3.814697265625e-6f;

/// Canonical; longer than any ray within the scene, or from before it.
const float kPortalReach = 8.0f;

/// Parallel light with a smaller cosine to a facet's normal is not guided to it: that cosine has an
/// error of 5 e, and the point where a line crosses the plane has that error divided by the cosine.
const float kPortalEdgeOn = 1e-4f;

/// e: the share of a facet's points that is drawn in its surround [portals.h]; and how much larger
/// this is than the smallest rectangle around the facet at either end of a side, over that side.
///
/// Measured in cornell-box-portal, efficiency over that without surrounds: 0.97 (tdpt-guided) and
/// 0.99 (tdpt) where the outline is right, since e (1 - A_F / A_R) of the samples are lost; 1.4
/// where a tenth of the hole is beside the portal, and 1.2 there with a margin of 0.05.
const float kSurroundShare = 0.08f;
const float kSurroundMargin = 0.1f;

/// A triangle, or a facet's surround: a rectangle.
#define TEXELS_OF_PortalPolygon(VEC, WORDS, PART)                                      \
  /* end_of_all: cumulative share of the points on all polygons, including this one */ \
  VEC(p0, float, end_of_all)                                                           \
  /* end_of_facet: the same within its facet */                                        \
  VEC(e1, float, end_of_facet)                                                         \
  /* portal: index of the portal that it is part of */                                 \
  VEC(e2, uint, portal)                                                                \
  /* grad1: barycentric b1 = dot(grad1, p - p0), b2 = dot(grad2, p - p0) */            \
  VEC(grad1, uint, facet)                                                              \
  VEC(grad2, uint, pad)
RECORD(PortalPolygon)

/// The triangles of a portal in one plane.
#define TEXELS_OF_PortalFacet(VEC, WORDS, PART)                                         \
  /* normal: from the light's side to the camera's */                                   \
  VEC(normal, float, area)                                                              \
  /* centre: lies in the plane */                                                       \
  /* surround: e A_F / A_R */                                                           \
  VEC(centre, float, surround)                                                          \
  /* density: (1-c) p(F) / (A_F pi) */                                                  \
  /* border: barycentric distance from a triangle's border that is clear of rounding */ \
  /* first .. end-1: its polygons; the last one is its surround */                      \
  WORDS(float, density, float, border, uint, first, uint, end)                          \
  /* first_pair: of the pairs that light crosses this facet first of */                 \
  WORDS(uint, first_corner, uint, end_corner, uint, first_pair, uint, end_pair)         \
  WORDS(float, per_area, uint, pad0, uint, pad1, uint, pad2)
RECORD(PortalFacet)

#define TEXELS_OF_PortalCorner(VEC, WORDS, PART) VEC(at, uint, pad)
RECORD(PortalCorner)

/// A pair of facets that segments are drawn through both of; light crosses `first` before `second`.
#define TEXELS_OF_PortalPair(VEC, WORDS, PART)                 \
  /* pdf: c p(F,G) / (A_F A_G) */                              \
  /* end: cumulative share of all pairs, including this one */ \
  WORDS(uint, first, uint, second, float, pdf, float, end)
RECORD(PortalPair)

/// Sizes of the tables, and the share c of the segments that is drawn through pairs.
struct GuideParameters {
  uint facets;
  uint polygons;
  uint pairs;
  float pair_share;      ///< c
  float per_pair_share;  ///< 1/c; 0 if c is 0
  uint pad0;
  uint pad1;
  uint pad2;
};

/// Polygons that a segment was drawn through, the second one for a pair; -1: none. They always
/// count as crossed, although rounding at a border may go either way; a neighbour of a triangle in
/// the same plane then counts only if the crossing is clear of the border.
struct Drawn {
  int polygon;
  int second;
};
SHARED Drawn drawn_through(int polygon, int second) {
  Drawn drawn = {polygon, second};
  return drawn;
}
SHARED Drawn drawn_through(int polygon) {
  return drawn_through(polygon, -1);
}
SHARED Drawn drawn_otherwise() {
  return drawn_through(-1, -1);
}

/// Densities of what can have made an edge from the light's side to the camera's.
struct CrossingDensity {
  float density;  ///< D
  /// a(w) * W [1/sr] (for parallel light: C of the facets crossed) of a guided walk from the light
  /// at the edge's beginning, and of one from the camera at its end.
  float from_light;
  float from_camera;
};
SHARED CrossingDensity no_crossing() {
  CrossingDensity c = {0.0f, 0.0f, 0.0f};
  return c;
}

/// A line drawn through a portal.
struct SegmentDraw {
  Drawn drawn;
  vec3 position;   ///< x_p
  vec3 direction;  ///< unit, towards the camera's side
  uint portal;
};

/// How a line crosses a facet along its normal.
struct PortalPassage {
  float before;  ///< heights of the line's ends over the plane, < 0 on the light's side
  float after;
  float cosine;
  float coverage;  ///< C there; 0: not crossed
};

#ifdef __cplusplus
RECORD_OF_REALS(PortalPolygon)
RECORD_OF_REALS(PortalFacet)
RECORD_OF_REALS(PortalPair)
static_assert(sizeof(PortalPolygon) == 80 && sizeof(PortalFacet) == 80);
static_assert(sizeof(PortalCorner) == 16 && sizeof(PortalPair) == 16);
static_assert(sizeof(GuideParameters) == 32);
#endif

SHARED_END

#include "shaders/shared/language_end.h"

#endif
