// Portals in flat tables, as portals.h reads them; C++ has them in doubles, too. Everything is
// canonical.
#ifndef TDPT_SHADERS_SHARED_PATH_PORTAL_LAYOUT_H
#define TDPT_SHADERS_SHARED_PATH_PORTAL_LAYOUT_H

#include "shaders/shared/path/point.h"
#include "shaders/shared/records.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// A portal counts only for segments that begin and end at least this far from its plane, 2^-18.
///
/// Where a portal lies in a surface, rounding must not decide what crosses it. With e = 2^-24 and a
/// place that lies no further than 3.5 from the middle of a facet, the scene's size, its height
/// over the facet's plane is off by 0.9 e for the middle, 0.9 * 3.5 e for the normal, 3.5 e for the
/// difference and 3 * 3.5 e for the products: 18 e. A place on a surface is off by 4 e, and so are
/// the corners that it was made of: in all 26 e. Half the margin is 32 e, so that a ray which
/// begins half a margin behind the plane begins behind what lies in it, and what lies in it is on
/// neither side.
const float kPortalMargin = 3.814697265625e-6f;

/// Canonical; no ray within the scene, or from before it, is as long.
const float kPortalReach = 8.0f;

/// Parallel light with a smaller cosine to a facet's normal is not directed at it: that cosine is
/// off by 5 e, and a line of it by as much over the cosine where it passes the plane.
const float kPortalEdgeOn = 1e-4f;

/// A triangle.
#define TEXELS_OF_PortalPolygon(VEC, WORDS, PART)                             \
  /* end_of_all: share of the area of all polygons up to and with this one */ \
  VEC(p0, float, end_of_all)                                                  \
  /* end_of_facet: the same within its facet */                               \
  VEC(e1, float, end_of_facet)                                                \
  /* portal: which of the portals it is part of */                            \
  VEC(e2, uint, portal)                                                       \
  /* grad1: barycentric b1 = dot(grad1, p - p0), b2 = dot(grad2, p - p0) */   \
  VEC(grad1, uint, facet)                                                     \
  VEC(grad2, uint, pad)
RECORD(PortalPolygon)

/// The triangles of a portal that lie in one plane.
#define TEXELS_OF_PortalFacet(VEC, WORDS, PART)                                          \
  /* normal: from the light's side to the camera's */                                    \
  VEC(normal, float, area)                                                               \
  /* centre: lies in the plane */                                                        \
  /* reach2: squared distance from the centre that no corner has, whatever is rounded */ \
  VEC(centre, float, reach2)                                                             \
  /* density: (1-c) p(q) / (A_q pi) of each of its triangles */                          \
  /* border: barycentric: what lies as far within each is clear of rounding */           \
  /* first: of its polygons */                                                           \
  WORDS(float, density, float, border, uint, first, uint, end)                           \
  /* first_pair: of the pairs that light passes it first of */                           \
  WORDS(uint, first_corner, uint, end_corner, uint, first_pair, uint, end_pair)          \
  WORDS(float, per_area, uint, pad0, uint, pad1, uint, pad2)
RECORD(PortalFacet)

#define TEXELS_OF_PortalCorner(VEC, WORDS, PART) VEC(at, uint, pad)
RECORD(PortalCorner)

/// Two facets that segments are drawn through both of, light passing `first` before `second`.
#define TEXELS_OF_PortalPair(VEC, WORDS, PART)          \
  /* pdf: c p(F,G) / (A_F A_G) */                       \
  /* end: share of all pairs up to and with this one */ \
  WORDS(uint, first, uint, second, float, pdf, float, end)
RECORD(PortalPair)

/// Sizes of the tables, and of the segments the share c that is drawn through pairs.
struct GuideParameters {
  uint facets;
  uint polygons;
  uint pairs;
  float pair_share;      ///< c
  float per_pair_share;  ///< 1/c; 0 where c is
  uint pad0;
  uint pad1;
  uint pad2;
};

/// Triangles that a segment was drawn through, the second of a pair; -1: none. They are counted as
/// crossed, as borders round either way, and a neighbour in their plane only when the crossing is
/// clear of the border.
struct Drawn {
  int polygon;
  int second;
};
SHARED Drawn drawn_through(int polygon, int second) {
  Drawn drawn;
  drawn.polygon = polygon;
  drawn.second = second;
  return drawn;
}
SHARED Drawn drawn_through(int polygon) {
  return drawn_through(polygon, -1);
}
SHARED Drawn drawn_otherwise() {
  return drawn_through(-1, -1);
}

/// What can have made an edge from the light's side to the camera's.
struct CrossingDensity {
  float density;  ///< D
  /// a(w) * W [1/sr], of parallel light the triangles crossed: of a walk from the light that stands
  /// at the edge's beginning, and of one from the camera that stands at its end.
  float from_light;
  float from_camera;
};
SHARED CrossingDensity no_crossing() {
  CrossingDensity c;
  c.density = 0.0f;
  c.from_light = 0.0f;
  c.from_camera = 0.0f;
  return c;
}

/// A line drawn through a portal.
struct SegmentDraw {
  Drawn drawn;
  vec3 position;   ///< x_p
  vec3 direction;  ///< unit, towards the camera's side
  uint portal;
};

/// Where a line passes a facet along its normal.
struct PortalPassage {
  float before;  ///< height of the line's ends over the plane, < 0 on the light's side
  float after;
  float cosine;
  int triangles;  ///< crossed there; 0: none
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
