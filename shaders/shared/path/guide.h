// Path guiding by the portals: a walk on the side of a portal that it must cross takes its next
// direction, with some probability, towards a point on the portal ("the walk is guided"), otherwise
// from the BSDF.
//
// Method: one-sample mixture of BSDF sampling and of sampling the portals as if they were lights;
// its density is known in closed form, nothing is learnt.
//
// w     direction
// q     probability that a vertex aims at a portal
// p(w)  density of the surface's own sampling, a(w) that of aiming [portals.h] [1/sr]
// m     probability that no Dirac lobe was chosen: those lobes are left as they are
// b     1; but for a surface without a Dirac lobe and with a narrow one (alpha < 0.3), the
//       probability that it would scatter by its diffuse lobe: a metal floor seldom reflects the
//       portal towards the direction that it is seen from
//
//   pdf_w = (1-qb) p(w) + qb m a(w),
//
// and the walk ends where p = 0: nothing is scattered there.
//
// Where a walk scatters, a guided step takes the place of its end, not of a step by the BSDF. By
// roulette a plain walk ends with probability 1 - albedo [walk.h]; of these ends a share G is
// guided instead:
//   survival s = albedo + G (1 - albedo),    q = G (1 - albedo) / s = G / (1-G) * (1-s) / s.
// A step by the BSDF then still has probability albedo and leaves the throughput as it is. If
// survival stayed the albedo, each would multiply it by 1 / (1-q): throughput would exceed t with a
// probability that falls only as a power of t, about t^-2.7 at q = 0.4 (1 - albedo), and long walks
// that never aimed would leave single bright pixels. Measured at equal time against that: 1.07 and
// 1.08 times the efficiency in three rooms and behind a door ajar, 1.1 to 2 times in houses.
//
// P> and P< of a path [eq. 7] become these densities; nothing else changes. Every walk is guided:
// the advantage of plain walks where lamps are seen directly is matched by the MIS sample weights
// of next events, without loss elsewhere [mixture.h].
//
// Include after portals.h and in a scope that has
//   render.guide_light, render.guide_camera
//       the probability that a vertex of a walk aims at a portal
//   guide_active    whether any walk may be guided; otherwise only D is computed
//   bool source_met(Source source), bool source_at_infinity(Source source)
//       whether rays can hit a source (SOURCE_NONE: true), whether it is infinitely far (false)
//   VEC3 source_facing(Source source, VEC3 normal)
//       the side that light begins on; 0: both
//   REAL albedo_at(Point p, Arrival back), Odds odds_at(Point p, Arrival back)
//       for Russian roulette; the probability of a Dirac lobe and, if there may be a narrow lobe,
//       of the diffuse one (else 1); odds_at() is called only for points that are not simple.

#include "shaders/shared/language.h"

/// Whether an edge a -> b of a path, a nearer to the light, has a crossing; the only place that
/// decides it. The camera's own edge has none, since no technique puts a portal there. No segment
/// ends on a light without surface: only guided walks need the crossings of its edges.
SHARED bool has_crossing(IN(Point) a, IN(Point) b) MEMBER_CONST {
  return scene_has_portals && on_surface(b) && (source_met(a.source) || guide_active);
}
/// Crossing density of the edge.
SHARED CrossingDensity edge_crossing(IN(Point) a, IN(Point) b, Drawn drawn) MEMBER_CONST {
  CrossingDensity c = no_crossing();
  if (!has_crossing(a, b)) return c;
  bool far_away = source_at_infinity(a.source);
  VEC3 from = far_away ? before_the_scene(b.position, a.position) : a.position;
  if (!guide_active) {
    c.density = portal_density(from, b.position, drawn);
    return c;
  }
  c = portal_crossing(from, b.position, drawn);
  if (far_away) c.from_light = coverage_along(a.position, b.position, drawn);
  if (!source_met(a.source)) c.density = 0.0f;
  return c;
}

SHARED REAL emitted_guide_total(IN(Point) p, VEC3 facing) MEMBER_CONST {
  return portal_guide_total(source_at_infinity(p.source), p.position, facing, FROM_LIGHT);
}

/// Normal on the side of the surface at `p` that holds all edges of a path with one along `away`; 0
/// if light passes through, so that both sides count.
SHARED VEC3 guide_facing(IN(Point) p, VEC3 away) MEMBER_CONST {
  if (!p.simple && !is_zero(p.bsdf.through)) return VEC3(0.0f);
  return dot(p.normal, away) > 0.0f ? p.normal : -p.normal;
}

/// Guide totals of a surface that is seen along unit `away` from it, or was left along it.
SHARED GuideTotals guide_totals_at_surface(IN(Point) p, VEC3 away) MEMBER_CONST {
  GuideTotals guide_totals = {guide_facing(p, away), 0.0f, 0.0f, 0.0f};
  if (!scene_has_portals || !guide_active) return guide_totals;
  if (p.connectible) {
    VEC3 facing = guide_totals.facing;
    guide_totals.from_light = portal_guide_total(false, p.position, facing, FROM_LIGHT);
    guide_totals.from_camera = portal_guide_total(false, p.position, facing, FROM_CAMERA);
  }
  if (p.source != SOURCE_NONE)
    guide_totals.emitted = emitted_guide_total(p, source_facing(p.source, p.normal));
  return guide_totals;
}

/// The same at y_0, a point on a light.
SHARED GuideTotals guide_totals_at_light(IN(Point) y0) MEMBER_CONST {
  GuideTotals guide_totals = {source_facing(y0.source, y0.normal), 0.0f, 0.0f, 0.0f};
  if (!scene_has_portals || !guide_active) return guide_totals;
  guide_totals.emitted = emitted_guide_total(y0, guide_totals.facing);
  return guide_totals;
}

/// W at a vertex where a walk arrived from unit `back` (0: it begins there).
SHARED REAL guide_total_of(IN(GuideTotals) guide_totals, Arrival back, uint from) MEMBER_CONST {
  if (begins(back)) return guide_totals.emitted;
  return from == FROM_LIGHT ? guide_totals.from_light : guide_totals.from_camera;
}

SHARED REAL guide_first_chance(uint from) MEMBER_CONST {
  return from == FROM_LIGHT ? render.guide_light : render.guide_camera;
}
/// G: more would make walks long.
SHARED REAL guide_share_of_ends(uint from) MEMBER_CONST {
  return min(guide_first_chance(from), REAL(0.3));
}
/// s where a walk scatters; W: guide total.
SHARED REAL guided_survival(uint from, REAL W, REAL albedo) MEMBER_CONST {
  if (!(W > 0.0f)) return albedo;
  return albedo + guide_share_of_ends(from) * (1.0f - albedo);
}
/// q where a walk scatters that has something to aim at, from s.
SHARED REAL guide_chance_at(uint from, REAL survival) MEMBER_CONST {
  REAL G = guide_share_of_ends(from);
  return G * (1.0f - survival) * reciprocal((1.0f - G) * survival);
}
SHARED REAL guide_chance(uint from, IN(Point) v, Arrival back) MEMBER_CONST {
  if (begins(back)) return guide_first_chance(from);
  return guide_chance_at(from, guided_survival(from, 1.0f, albedo_at(v, back)));
}

/// b and 1 - m of a walk that came from `back`.
SHARED OF_REAL(Odds) guide_odds(IN(Point) at, Arrival back) MEMBER_CONST {
  OF_REAL(Odds) odds = {0.0f, 1.0f};
  if (at.simple || begins(back)) return odds;
  return odds_at(at, back);
}

/// Whether a walk at `v` that came from unit `back` (0: it begins there) is guided, and if so its
/// direction and the triangle aimed at (else -1). Random numbers: two for the place on a facet, one
/// to choose the facet, one for the decision.
SHARED bool guide_draw(IN(Point) v, IN(GuideTotals) guide_totals, Arrival back, uint from, REAL u0,
                       REAL u1, REAL u2, REAL u3, OUT(VEC3) w, OUT(int) triangle) MEMBER_CONST {
  triangle = -1;
  w = VEC3(0.0f);
  if (!scene_has_portals || !guide_active) return false;
  REAL W = guide_total_of(guide_totals, back, from);
  if (!(W > 0.0f)) return false;
  REAL q = guide_chance(from, v, back);
  if (!(u3 < q) || !(u3 < q * guide_odds(v, back).broad)) return false;
  triangle = draw_towards_portal(v.position, guide_totals.facing, from, W, u0, u1, u2, w);
  return true;
}

/// Whether the walk that leaves y_0 is guided, and if so its ray and the triangle aimed at (else
/// -1).
SHARED bool guide_leave(IN(Point) y0, IN(GuideTotals) guide_totals, REAL u0, REAL u1, REAL u2,
                        REAL u3, INOUT(VEC3) origin, INOUT(VEC3) direction,
                        OUT(int) triangle) MEMBER_CONST {
  triangle = -1;
  if (!scene_has_portals || !guide_active) return false;
  if (!source_at_infinity(y0.source)) {
    VEC3 w = VEC3(0.0f);
    if (!guide_draw(y0, guide_totals, no_arrival(), FROM_LIGHT, u0, u1, u2, u3, w, triangle))
      return false;
    origin = y0.position;
    direction = w;
    return true;
  }
  if (!(guide_totals.emitted > 0.0f && u3 < render.guide_light)) return false;
  VEC3 at = VEC3(0.0f);
  triangle =
      draw_on_portal(true, direction, VEC3(0.0f), FROM_LIGHT, guide_totals.emitted, u0, u1, u2, at);
  origin = before_the_scene(at, direction);
  return true;
}

/// Guided density [1/canonical area] of a walk that leaves along an edge with this crossing, from
/// the plain density. W: guide total; q: probability of aiming; scope: Odds where it scatters;
/// per_area: |cos| / d^2 at the edge's other end.
SHARED REAL guided_pdf_A(uint from, REAL W, REAL q, OF_REAL(Odds) scope, REAL plain_A,
                         REAL per_area, CrossingDensity crossing) MEMBER_CONST {
  if (!(plain_A > 0.0f && guide_first_chance(from) > 0.0f && W > 0.0f)) return plain_A;
  REAL by_surface = (1.0f - q * scope.broad) * plain_A;
  // Portals that the infinite ray crosses.
  REAL towards = from == FROM_LIGHT ? crossing.from_light : crossing.from_camera;
  if (towards == 0.0f) return by_surface;
  REAL share = q * reciprocal(W) * (scope.broad * (1.0f - scope.dirac));
  return by_surface + share * towards * per_area;
}
/// The same at a point where the walk arrived from unit `back`, or begins (0).
SHARED REAL guided_pdf_A(uint from, IN(Point) at, IN(GuideTotals) guide_totals, Arrival back,
                         REAL plain_A, REAL per_area, CrossingDensity crossing) MEMBER_CONST {
  return guided_pdf_A(from, guide_total_of(guide_totals, back, from), guide_chance(from, at, back),
                      guide_odds(at, back), plain_A, per_area, crossing);
}

#include "shaders/shared/language_end.h"
