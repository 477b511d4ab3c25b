// Path guiding by the portals: where a walk stands on the side of a portal that it begins on, its
// next direction is drawn towards a point on the portal with some probability ("the walk is
// directed"), and as the surface scatters otherwise.
//
// Method: one-sample mixture of BSDF sampling and of sampling the portals as if they were lamps;
// its density is known in closed form, nothing is learnt.
//
// w     direction; q: probability that a vertex aims. Beyond the first, 0.4 (1 - albedo) at
// most:
//       a walk that does not aim carries 1 / (1 - q) as much from then on and survives with the
//       albedo [roulette.h], so that q >= 1 - albedo would let it grow without bound
// p(w)  density of the surface's own sampling, a(w) that of aiming [portals.h] [1/sr]
// m     probability that no Dirac lobe was tried: those lobes are left as they are
// b     1, but where a surface has no Dirac lobe and a narrow one (alpha < 0.3) the probability
//       that it would scatter by its diffuse lobe: a metal floor seldom shows the portal in the
//       direction that it is looked at from
//
//   pdf_w = (1-qb) p(w) + qb m a(w),
//
// and the walk ends where p = 0: nothing is scattered there. P> and P< of a path [eq. 7] become
// these; nothing else changes. Every walk is guided: what plain ones gain where lamps are seen
// directly, MIS sample weights of next events gain without loss elsewhere [mixture.h].
//
// Read behind portals.h and within a scope that has
//   render.guide_light, render.guide_camera
//       the probability that a vertex of a walk aims at a portal
//   guide_active    whether any walk may be directed; else only D is known
//   bool source_met(Source source), bool source_at_infinity(Source source)
//       whether rays meet a source (SOURCE_NONE: true) and whether it is infinitely far (false)
//   VEC3 source_facing(Source source, VEC3 normal)
//       the side that light begins on; 0: both
//   REAL albedo_at(Point p, Arrival back), Odds odds_at(Point p, Arrival back)
//       for roulette, and how likely a Dirac lobe is tried and, where a narrow lobe may be, the
//       diffuse one (else 1); odds_at() is asked of points that are not simple only.

#include "shaders/shared/language.h"

/// Whether an edge a -> b of a path, a nearer to the light, has a crossing: here alone it is
/// decided which edges have one. No technique puts a portal on the camera's own edge, and no
/// segment ends on a light without surface: of its edges only directed walks ask.
SHARED bool has_crossing(IN(Point) a, IN(Point) b) MEMBER_CONST {
  return scene_has_portals && on_surface(b) && (source_met(a.source) || guide_active);
}
/// What can have made it.
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
  if (far_away) c.from_light = REAL(crossed_along(a.position, b.position, drawn));
  if (!source_met(a.source)) c.density = 0.0f;
  return c;
}

SHARED REAL guide_total_at(IN(Point) p, VEC3 facing, uint from) MEMBER_CONST {
  if (source_at_infinity(p.source)) return portal_guide_total_along(p.position);
  return portal_guide_totals(p.position, facing, from);
}

/// The side of the surface at `p` that all edges of a path are on which has one along `away`; 0:
/// both, as light goes through.
SHARED VEC3 guide_facing(IN(Point) p, VEC3 away) MEMBER_CONST {
  if (!p.simple && !is_zero(p.bsdf.through)) return VEC3(0.0f);
  return dot(p.normal, away) > 0.0f ? p.normal : -p.normal;
}

/// How walks are directed at a surface that is seen along unit `away` from it, or was left along
/// it.
SHARED GuideTotals guide_totals_at_surface(IN(Point) p, VEC3 away) MEMBER_CONST {
  GuideTotals guide_totals;
  guide_totals.facing = guide_facing(p, away);
  guide_totals.from_light = 0.0f;
  guide_totals.from_camera = 0.0f;
  guide_totals.emitted = 0.0f;
  if (!scene_has_portals || !guide_active) return guide_totals;
  if (p.connectible)
    portal_guide_totals(p.position, guide_totals.facing, guide_totals.from_light,
                        guide_totals.from_camera);
  if (p.source != SOURCE_NONE)
    guide_totals.emitted = guide_total_at(p, source_facing(p.source, p.normal), FROM_LIGHT);
  return guide_totals;
}

/// The same at y_0, a place on a light.
SHARED GuideTotals guide_totals_at_light(IN(Point) y0) MEMBER_CONST {
  GuideTotals guide_totals;
  guide_totals.facing = source_facing(y0.source, y0.normal);
  guide_totals.from_light = 0.0f;
  guide_totals.from_camera = 0.0f;
  guide_totals.emitted = 0.0f;
  if (!scene_has_portals || !guide_active) return guide_totals;
  guide_totals.emitted = guide_total_at(y0, guide_totals.facing, FROM_LIGHT);
  return guide_totals;
}

/// W at a vertex that a walk came to from unit `back` (0: it begins there).
SHARED REAL guide_total_of(IN(GuideTotals) guide_totals, Arrival back, uint from) MEMBER_CONST {
  if (begins(back)) return guide_totals.emitted;
  return from == FROM_LIGHT ? guide_totals.from_light : guide_totals.from_camera;
}

SHARED REAL guide_first_chance(uint from) MEMBER_CONST {
  return from == FROM_LIGHT ? render.guide_light : render.guide_camera;
}
/// q where a walk scatters, at an albedo.
SHARED REAL guide_chance_at(uint from, REAL albedo) MEMBER_CONST {
  return min(guide_first_chance(from), REAL(0.4) * (1.0f - albedo));
}
SHARED REAL guide_chance(uint from, IN(Point) v, Arrival back) MEMBER_CONST {
  if (begins(back)) return guide_first_chance(from);
  return guide_chance_at(from, albedo_at(v, back));
}

/// b and 1 - m of a walk that came from `back`.
SHARED OF_REAL(Odds) guide_odds(IN(Point) at, Arrival back) MEMBER_CONST {
  OF_REAL(Odds) odds;
  odds.dirac = 0.0f;
  odds.broad = 1.0f;
  if (at.simple || begins(back)) return odds;
  return odds_at(at, back);
}

/// Whether a walk at `v` that came from unit `back` (0: it begins there) is directed, and then the
/// direction and the triangle aimed at (else -1). Numbers: place on a facet, its choice, and
/// whether.
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

/// Whether the walk that leaves y_0 is directed, and then its ray and the triangle aimed at (else
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
  triangle = draw_parallel_through_portal(direction, guide_totals.emitted, u0, u1, u2, at);
  origin = before_the_scene(at, direction);
  return true;
}

/// Of a walk that leaves along an edge with this crossing: the guided density [1/canonical area]
/// from the plain one. W: of what it may aim at; q: that it aims, scope: Odds of where it scatters;
/// per_area: |cos| / d^2 at the edge's other end.
SHARED REAL guided_pdf_A(uint from, REAL W, REAL q, OF_REAL(Odds) scope, REAL plain_A,
                         REAL per_area, CrossingDensity crossing) MEMBER_CONST {
  if (!(plain_A > 0.0f && guide_first_chance(from) > 0.0f && W > 0.0f)) return plain_A;
  REAL by_surface = (1.0f - q * scope.broad) * plain_A;
  // What the infinite ray crosses.
  REAL towards = from == FROM_LIGHT ? crossing.from_light : crossing.from_camera;
  if (towards == 0.0f) return by_surface;
  REAL share = q * reciprocal(W) * (scope.broad * (1.0f - scope.dirac));
  return by_surface + share * towards * per_area;
}
/// The same at a point that the walk came to from unit `back`, or begins at (0).
SHARED REAL guided_pdf_A(uint from, IN(Point) at, IN(GuideTotals) guide_totals, Arrival back,
                         REAL plain_A, REAL per_area, CrossingDensity crossing) MEMBER_CONST {
  return guided_pdf_A(from, guide_total_of(guide_totals, back, from), guide_chance(from, at, back),
                      guide_odds(at, back), plain_A, per_area, crossing);
}

#include "shaders/shared/language_end.h"
