// Samples segments, and directions of walks, through the portals, and gives the density with which
// any edge of a path would have been sampled so. Section 3.1.1, eq. 4.
//
// A portal is a set of triangles in the air, each with the normal given by its winding: the
// direction from the light's side to the camera's side. A facet F is the set of its triangles in
// one plane, of area A_F.
//
// No outline is exact: light that passes a little beside it would be left to the other techniques.
// So F has a surround R, the smallest rectangle around it with some space on all sides
// [portals.cpp], and a share e of its points is uniform on R (defensive sampling: Hesterberg 1995).
// A point x of its plane has the density
//   pdf_A(x) = C(x) / A_F,    C(x) = (1-e) n(x) + (x in R) e A_F / A_R,
// n(x) the number of F's triangles that hold x. C is the facet's coverage; all that follows has the
// points of portals by this density alone.
//
// Portal sampling: a polygon q, triangle or surround, with probability p(q) in proportion to (1-e)
// A_q or e A_F, a point uniform on it (p_A = 1/A_q), a direction with p_w = cos/pi about its
// normal, traced both ways to the surfaces x_l (light's side) and x_c (camera's side):
//   p_AA(x_l, x_c) = G(x_l, x_c) * sum_q p(q) p_A p_w / cos_q                              [eq. 4]
//                  = G(x_l, x_c) * D,    D = sum over the F crossed of C p(F) / (A_F pi).
// A portal that light crosses both ways is two facets, one of either winding.
// The cosine cancels: no grazing singularity. This file computes D [1/(m2 sr)], canonical.
//
// Portals in series: if one follows another on the light's way (doors of rooms in a row), little
// light passes both without touching a wall between them, and a segment through one crosses the
// other only by chance. So for such pairs (F,G) a share c of the segments is drawn through a point
// on each of the two, a pair with probability p(F,G):
//   D = (1-c) sum_F C_F p(F) / (A_F pi)
//       + c sum over the pairs crossed of p(F,G) C_F C_G d^2 / (A_F A_G cos_F cos_G),
// d the distance between the points where the segment crosses the two.
//
// Path guiding [guide.h] aims walks at facets as light sampling aims at lights. From v, facet F is
// chosen in proportion to w_F(v), about its solid angle, then a point on it; its direction w has
// the density
//   a(w) = sum over the facets F that the ray (v, w) crosses of  w_F(v) / W  * C d^2 / (|cos| A_F),
// d the distance to the plane along w, W the sum of w_F(v) over the facets that v can aim at.
//
// Precision in floats: crossings are computed from the nearer end of an edge, and distances to a
// plane are heights over cosines, so that errors do not grow for short edges. Whether an edge has
// its ends on either side of a plane is decided by their heights everywhere, so that a segment that
// was drawn through a facet and spans it always crosses it; if known, `Drawn` says which of the
// facet's polygons it crosses. portal_layout.h gives the margins.
//
// Include in a scope that has
//   load_portal_facet(i) and all others of TABLES_OF_PORTALS [tables.h]
//   GuideParameters guiding
//   scene_has_portals, portals_have_pairs

#include "shaders/shared/path/portal_layout.h"
#include "shaders/shared/rng.h"

#include "shaders/shared/language.h"

/// Height of p over the facet's plane; < 0 on the light's side.
SHARED REAL portal_height(IN(PortalFacet) f, VEC3 p) MEMBER_CONST {
  return dot(f.normal, p - f.centre);
}

/// Whether a point of its plane lies in the triangle, at least `inside` (barycentric) from its
/// borders.
SHARED bool triangle_holds(IN(PortalPolygon) p, VEC3 at, REAL inside) MEMBER_CONST {
  VEC3 d = at - p.p0;
  REAL b1 = dot(p.grad1, d);
  REAL b2 = dot(p.grad2, d);
  return b1 >= inside && b2 >= inside && b1 + b2 <= 1.0f - inside;
}

SHARED bool surround_holds(IN(PortalPolygon) p, VEC3 at) MEMBER_CONST {
  VEC3 d = at - p.p0;
  REAL b1 = dot(p.grad1, d);
  REAL b2 = dot(p.grad2, d);
  return min(b1, b2) >= 0.0f && max(b1, b2) <= 1.0f;
}

/// C of the facet at `at`, a point of its plane.
SHARED REAL portal_coverage(IN(PortalFacet) f, VEC3 at, Drawn drawn) MEMBER_CONST {
  int first = int(f.first);
  int surround = int(f.end) - 1;
  bool polygon_here = drawn.polygon >= first && drawn.polygon <= surround;
  bool second_here = drawn.second >= first && drawn.second <= surround;
  int here = polygon_here ? drawn.polygon : second_here ? drawn.second : -1;
  if (here < 0 && !surround_holds(load_portal_polygon(uint(surround)), at)) return 0.0f;
  REAL inside = here < 0 || here == surround ? 0.0f : f.border;
  int n = 0;
  for (int i = first; i < surround; ++i)
    n += i == here || triangle_holds(load_portal_polygon(uint(i)), at, inside) ? 1 : 0;
  return f.surround + (1.0f - REAL(kSurroundShare)) * REAL(n);
}

/// 1 / |d|; 0 if d is too short.
SHARED REAL portal_per_length(VEC3 d) MEMBER_CONST {
  REAL d2 = dot(d, d);
  return d2 > 1e-36f ? inverse_root(d2) : REAL(0.0f);
}

/// How the line through `from` and `to` crosses a facet along its normal. `beyond`: one of them may
/// be on the wrong side of it; `d`: to - from; `per_length`: 1 / |d|.
SHARED PortalPassage portal_passage(IN(PortalFacet) f, VEC3 from, VEC3 to, VEC3 d, REAL per_length,
                                    bool beyond, Drawn drawn) MEMBER_CONST {
  PortalPassage p;
  p.coverage = 0.0f;
  REAL slope = dot(f.normal, d);
  if (!(slope > 0.0f)) return p;
  p.before = portal_height(f, from);
  p.after = portal_height(f, to);
  bool begins = p.before < -kPortalMargin;
  bool ends = p.after > kPortalMargin;
  if (!(begins && ends) && !(beyond && (begins || ends))) return p;
  p.cosine = slope * per_length;
  bool nearer = abs(p.before) < abs(p.after);
  REAL height = nearer ? p.before : p.after;
  if (abs(height) < kPortalReach * p.cosine) {
    VEC3 at = (nearer ? from : to) - d * (height * reciprocal(slope));
    p.coverage = portal_coverage(f, at, drawn);
  }
  return p;
}

/// The part of D from pairs whose first facet is k.
SHARED REAL portal_density_of_pairs(uint k, VEC3 from, VEC3 to, VEC3 d, REAL per_length,
                                    Drawn drawn) MEMBER_CONST {
  REAL all = 0.0f;
  IN(PortalFacet) facet = load_portal_facet(k);
  PortalPassage of_f = portal_passage(facet, from, to, d, per_length, false, drawn);
  REAL per_f = of_f.coverage > 0.0f ? reciprocal(of_f.cosine) : REAL(0.0f);
  uint end = of_f.coverage > 0.0f ? facet.end_pair : 0u;
  for (uint i = facet.first_pair; i < end; ++i) {
    IN(PortalPair) pair = load_portal_pair(i);
    PortalPassage of_g =
        portal_passage(load_portal_facet(pair.second), from, to, d, per_length, false, drawn);
    if (of_g.coverage > 0.0f) {
      REAL per_g = reciprocal(of_g.cosine);
      REAL distance = of_g.before * per_g - of_f.before * per_f;
      all += of_f.coverage * of_g.coverage * pair.pdf * (distance * distance) * (per_f * per_g);
    }
  }
  return all;
}
/// The part of D from pairs. `crossed`: which of the first 32 facets are crossed, a bit each: a
/// group of lanes iterates only as often as its lane with the most crossings.
SHARED REAL portal_pair_density(uint crossed, VEC3 from, VEC3 to, VEC3 d, REAL per_length,
                                Drawn drawn) MEMBER_CONST {
  REAL all = 0.0f;
  uint rest = crossed;
  while (rest != 0u) {
    uint k = uint(findLSB(rest));
    rest = rest & (rest - 1u);
    all += portal_density_of_pairs(k, from, to, d, per_length, drawn);
  }
  for (uint k = 32u; k < guiding.facets; ++k)
    all += portal_density_of_pairs(k, from, to, d, per_length, drawn);
  return all;
}

/// D of [eq. 4] of the segment `from` (light's side) -> `to` (camera's side); 0 if it crosses no
/// facet along its normal.
SHARED REAL portal_density(VEC3 from, VEC3 to, Drawn drawn) MEMBER_CONST {
  if (!scene_has_portals) return 0.0f;
  REAL sum = 0.0f;
  uint crossed = 0u;
  VEC3 d = to - from;
  REAL per_length = portal_per_length(d);
  for (uint f = 0u; f < guiding.facets; ++f) {
    IN(PortalFacet) facet = load_portal_facet(f);
    PortalPassage p = portal_passage(facet, from, to, d, per_length, false, drawn);
    sum += p.coverage * facet.density;
    crossed |= p.coverage > 0.0f && f < 32u ? 1u << (f & 31u) : 0u;
  }
  if (portals_have_pairs) sum += portal_pair_density(crossed, from, to, d, per_length, drawn);
  return sum;
}

/// w_F(v), positive off the plane.
SHARED REAL portal_weight(IN(PortalFacet) f, VEC3 v) MEMBER_CONST {
  if (guiding.facets == 1u) return 1.0f;
  VEC3 d = f.centre - v;
  REAL d2 = dot(d, d);
  // At grazing angles a facet keeps a tenth of the weight.
  REAL height = abs(dot(f.normal, d));
  if (height * height < REAL(0.01) * d2) height = REAL(0.1) * root(d2);
  REAL area = f.area;
  REAL per_reach = inverse_root(d2 + area * INVERSE_PI);
  return area * height * (per_reach * per_reach * per_reach);
}

SHARED CrossingDensity portal_crossing(VEC3 from, VEC3 to, Drawn drawn) MEMBER_CONST {
  CrossingDensity c = no_crossing();
  if (!scene_has_portals) return c;
  uint crossed = 0u;
  VEC3 d = to - from;
  REAL per_length = portal_per_length(d);
  for (uint f = 0u; f < guiding.facets; ++f) {
    IN(PortalFacet) facet = load_portal_facet(f);
    PortalPassage p = portal_passage(facet, from, to, d, per_length, true, drawn);
    if (!(p.coverage > 0.0f)) continue;
    bool begins = p.before < -kPortalMargin;
    bool ends = p.after > kPortalMargin;
    if (begins && ends) c.density += p.coverage * facet.density;
    crossed |= begins && ends && f < 32u ? 1u << (f & 31u) : 0u;
    // d^2 / (cos A), where d is the height over the cosine.
    REAL per_cosine = reciprocal(p.cosine);
    REAL per_area = p.coverage * facet.per_area * (per_cosine * per_cosine * per_cosine);
    if (begins) c.from_light += portal_weight(facet, from) * (p.before * p.before) * per_area;
    if (ends) c.from_camera += portal_weight(facet, to) * (p.after * p.after) * per_area;
  }
  if (portals_have_pairs) c.density += portal_pair_density(crossed, from, to, d, per_length, drawn);
  return c;
}

/// Whether x_l and x_c lie on either side of all polygons that the segment was drawn through: one
/// drawn through a pair and stopped in between is of no use.
SHARED bool segment_spans(Drawn drawn, VEC3 x_l, VEC3 x_c) MEMBER_CONST {
  for (int i = 0; i < 2; ++i) {
    int polygon = i == 0 ? drawn.polygon : drawn.second;
    if (polygon < 0) continue;
    IN(PortalFacet) f = load_portal_facet(load_portal_polygon(uint(polygon)).facet);
    if (!(portal_height(f, x_l) < -kPortalMargin && portal_height(f, x_c) > kPortalMargin))
      return false;
  }
  return true;
}

/// The polygon of first .. end-1 at u in the cumulative area of all, or of its facet.
SHARED uint polygon_picked(uint first, uint end, bool of_all, REAL u) MEMBER_CONST {
  uint low = first;
  uint high = end - 1u;
  while (low < high) {
    uint middle = (low + high) >> 1u;
    REAL up_to =
        of_all ? load_portal_polygon(middle).end_of_all : load_portal_polygon(middle).end_of_facet;
    if (u < up_to)
      high = middle;
    else
      low = middle + 1u;
  }
  return low;
}

SHARED VEC3 point_in_polygon(uint i, REAL u, REAL v) MEMBER_CONST {
  IN(PortalPolygon) p = load_portal_polygon(i);
  REAL b1 = u;
  REAL b2 = v;
  if (i + 1u < load_portal_facet(p.facet).end) uniform_triangle(u, v, b1, b2);
  return p.p0 + (p.e1 * b1 + p.e2 * b2);
}

SHARED VEC3 point_on_facet(uint f, REAL pick, REAL u, REAL v, OUT(int) polygon) MEMBER_CONST {
  IN(PortalFacet) facet = load_portal_facet(f);
  uint i = polygon_picked(facet.first, facet.end, false, pick);
  polygon = int(i);
  return point_in_polygon(i, u, v);
}

/// Whether a corner of the facet is on the side of v that `facing` looks to (0: either).
SHARED bool portal_above(IN(PortalFacet) f, VEC3 v, VEC3 facing) MEMBER_CONST {
  // If the centre is, a corner is, except for rounding.
  bool above = is_zero(facing) || dot(facing, f.centre - v) > kPortalMargin;
  uint end = f.end_corner;
  for (uint i = f.first_corner; i < end && !above; ++i)
    above = dot(facing, load_portal_corner(i).at - v) > 0.0f;
  return above;
}

/// w_F(v) for walks from one end at v; 0 if they do not aim at the facet: they begin on its other
/// side, or no corner is on the side of v that `facing` looks to (0: either). `parallel`: v is the
/// unit direction of parallel light, and the weight A_F cos_F; 0 if edge-on or from the front.
SHARED REAL aiming_weight(IN(PortalFacet) f, bool parallel, VEC3 v, VEC3 facing,
                          uint from) MEMBER_CONST {
  if (parallel) {
    REAL cosine = dot(f.normal, v);
    return cosine > kPortalEdgeOn ? f.area * cosine : REAL(0.0f);
  }
  REAL height = portal_height(f, v);
  if (!((from == FROM_LIGHT ? -height : height) > kPortalMargin)) return 0.0f;
  return portal_above(f, v, facing) ? portal_weight(f, v) : REAL(0.0f);
}

/// W: the sum of those weights; 0: nothing to aim at.
SHARED REAL portal_guide_total(bool parallel, VEC3 v, VEC3 facing, uint from) MEMBER_CONST {
  REAL sum = 0.0f;
  uint facets = scene_has_portals ? guiding.facets : 0u;
  for (uint f = 0u; f < facets; ++f)
    sum += aiming_weight(load_portal_facet(f), parallel, v, facing, from);
  return sum;
}

/// Samples a point on a facet that walks from v, or parallel light along v, aim at; W must be that
/// of portal_guide_total() for the same arguments, and positive. `u`, `v_`: place on the facet;
/// `pick`: chooses it. Returns the polygon aimed at.
SHARED int draw_on_portal(bool parallel, VEC3 v, VEC3 facing, uint from, REAL W, REAL u, REAL v_,
                          REAL pick, OUT(VEC3) at) MEMBER_CONST {
  REAL rest = pick * W;
  uint chosen = 0u;
  REAL weight = 1.0f;
  for (uint f = 0u; f < guiding.facets; ++f) {
    REAL of_facet = aiming_weight(load_portal_facet(f), parallel, v, facing, from);
    if (!(of_facet > 0.0f)) continue;
    chosen = f;
    weight = of_facet;
    rest -= weight;
    if (rest < 0.0f) break;
  }
  // The remainder of the number that chose the facet chooses the polygon within it.
  REAL within = min(max(1.0f + rest * reciprocal(weight), 0.0f), 1.0f);
  int polygon = 0;
  at = point_on_facet(chosen, within, u, v_, polygon);
  return polygon;
}
/// The unit direction from v towards such a point.
SHARED int draw_towards_portal(VEC3 v, VEC3 facing, uint from, REAL W, REAL u, REAL v_, REAL pick,
                               OUT(VEC3) w) MEMBER_CONST {
  VEC3 at = VEC3(0.0f);
  int polygon = draw_on_portal(false, v, facing, from, W, u, v_, pick, at);
  w = normalized(at - v);
  return polygon;
}

/// Sum of C of the facets crossed by the line along d that arrives at `to`.
SHARED REAL coverage_along(VEC3 d, VEC3 to, Drawn drawn) MEMBER_CONST {
  REAL sum = 0.0f;
  for (uint f = 0u; f < guiding.facets; ++f) {
    IN(PortalFacet) facet = load_portal_facet(f);
    REAL cosine = dot(facet.normal, d);
    if (!(cosine > kPortalEdgeOn)) continue;
    REAL t = portal_height(facet, to) * reciprocal(cosine);
    sum += portal_coverage(facet, to - d * t, drawn);
  }
  return sum;
}

/// Samples a segment: two numbers for the place on a polygon, two for the direction, three to
/// choose polygons. There must be portals.
SHARED SegmentDraw sample_segment(REAL u0, REAL u1, REAL u2, REAL u3, REAL u4, REAL u5,
                                  REAL u6) MEMBER_CONST {
  SegmentDraw s;
  if (portals_have_pairs && u5 < guiding.pair_share) {
    REAL u = u5 * guiding.per_pair_share;
    uint low = 0u;
    uint high = guiding.pairs - 1u;
    while (low < high) {
      uint middle = (low + high) >> 1u;
      if (u < load_portal_pair(middle).end)
        high = middle;
      else
        low = middle + 1u;
    }
    int first = 0;
    int second = 0;
    IN(PortalPair) pair = load_portal_pair(low);
    s.position = point_on_facet(pair.first, u4, u0, u1, first);
    VEC3 to = point_on_facet(pair.second, u6, u2, u3, second);
    s.direction = normalized(to - s.position);
    s.drawn.polygon = first;
    s.drawn.second = second;
    s.portal = load_portal_polygon(first).portal;
    return s;
  }
  uint i = polygon_picked(0u, guiding.polygons, true, u4);
  s.position = point_in_polygon(i, u0, u1);
  s.direction =
      normalized(cosine_hemisphere(load_portal_facet(load_portal_polygon(i).facet).normal, u2, u3));
  s.drawn.polygon = int(i);
  s.drawn.second = -1;
  s.portal = load_portal_polygon(i).portal;
  return s;
}

/// Where both rays of a segment begin: behind the portal by half the margin, so that a surface in
/// its plane, often a pane, is hit by only one of them.
SHARED VEC3 segment_start(SegmentDraw s) MEMBER_CONST {
  uint f = load_portal_polygon(s.drawn.polygon).facet;
  return s.position - load_portal_facet(f).normal * (0.5f * kPortalMargin);
}

#include "shaders/shared/language_end.h"
