// Path guiding by the portals: tools/tdpt-render/path/sample/guide.h in floats, where the method
// and all symbols are told.
//
// Read behind portals.h and within a scope that has
//   render.guide_light, render.guide_camera
//       the probability that a vertex of a walk aims at a portal
//   guide_active    whether any walk may be directed; else only D is known
//   bool source_met(uint source), bool source_at_infinity(uint source)
//       whether rays meet a source (SOURCE_NONE: true) and whether it is infinitely far (false)
//   vec3 source_facing(uint source, vec3 normal)
//       the side that light begins on; 0: both
//   float albedo_at(Point p, vec3 back), Odds odds_at(Point p, vec3 back)
//       for roulette, and how likely a Dirac lobe is tried and, where a narrow lobe may be, the
//       diffuse one (else 1); odds_at() is asked of points that are not simple only.

#include "shaders/shared/language.h"

/// What can have made an edge a -> b of a path, a nearer to the light: here alone it is decided
/// which edges have one. `source`: of a, which need not be more than a place; `to_surface`: b is on
/// one.
SHARED Crossing edge_crossing_of(vec3 a, uint source, vec3 b, bool to_surface,
                                 Drawn drawn) MEMBER_CONST {
  Crossing c = no_crossing();
  if (!scene_has_portals) return c;
  // No technique puts a portal on the camera's own edge, and no segment ends on a light without
  // surface: of its edges only directed walks ask.
  bool met = source_met(source);
  if (!to_surface || !(met || guide_active)) return c;
  bool far_away = source_at_infinity(source);
  vec3 from = far_away ? before_the_scene(b, a) : a;
  if (!guide_active) {
    c.density = portal_density(from, b, drawn);
    return c;
  }
  c = portal_crossing(from, b, drawn);
  if (far_away) c.from_light = float(crossed_along(a, b, drawn));
  if (!met) c.density = 0.0f;
  return c;
}
SHARED Crossing edge_crossing(Point a, Point b, Drawn drawn) MEMBER_CONST {
  return edge_crossing_of(a.position, a.source, b.position, on_surface(b), drawn);
}

SHARED float guide_aims(Point p, vec3 facing, uint from) MEMBER_CONST {
  if (source_at_infinity(p.source)) return portal_aims_along(p.position);
  return portal_aims(p.position, facing, from);
}

/// The side of the surface at `p` that all edges of a path are on which has one along `away`; 0:
/// both, as light goes through.
SHARED vec3 guide_facing(Point p, vec3 away) MEMBER_CONST {
  if (!p.simple && !is_zero(p.bsdf.through)) return vec3(0.0f);
  return dot(p.normal, away) > 0.0f ? p.normal : -p.normal;
}

/// How walks are directed at a surface that is seen along unit `away` from it, or was left along
/// it.
SHARED Aims aim_at_surface(Point p, vec3 away) MEMBER_CONST {
  Aims aims;
  aims.facing = guide_facing(p, away);
  aims.from_light = 0.0f;
  aims.from_camera = 0.0f;
  aims.emitted = 0.0f;
  if (!scene_has_portals || !guide_active) return aims;
  if (p.connectible) portal_aims(p.position, aims.facing, aims.from_light, aims.from_camera);
  if (p.source != SOURCE_NONE)
    aims.emitted = guide_aims(p, source_facing(p.source, p.normal), FROM_LIGHT);
  return aims;
}

/// The same at y_0, a place on a light.
SHARED Aims aim_at_light(Point y0) MEMBER_CONST {
  Aims aims;
  aims.facing = source_facing(y0.source, y0.normal);
  aims.from_light = 0.0f;
  aims.from_camera = 0.0f;
  aims.emitted = 0.0f;
  if (!scene_has_portals || !guide_active) return aims;
  aims.emitted = guide_aims(y0, aims.facing, FROM_LIGHT);
  return aims;
}

/// W at a vertex that a walk came to from unit `back` (0: it begins there).
SHARED float guide_aim_of(Aims aims, vec3 back, uint from) MEMBER_CONST {
  if (is_zero(back)) return aims.emitted;
  return from == FROM_LIGHT ? aims.from_light : aims.from_camera;
}

SHARED float guide_first_chance(uint from) MEMBER_CONST {
  return from == FROM_LIGHT ? render.guide_light : render.guide_camera;
}
/// q.
SHARED float guide_chance(uint from, Point v, vec3 back) MEMBER_CONST {
  float chance = guide_first_chance(from);
  if (is_zero(back)) return chance;
  return min(chance, 0.4f * (1.0f - albedo_at(v, back)));
}

/// b and 1 - m of a walk that came from `back`.
SHARED OF_FLOAT(Odds) guide_odds(Point at, vec3 back) MEMBER_CONST {
  OF_FLOAT(Odds) odds;
  odds.dirac = 0.0f;
  odds.broad = 1.0f;
  if (at.simple || is_zero(back)) return odds;
  return odds_at(at, back);
}

/// Whether a walk at `v` that came from unit `back` (0: it begins there) is directed, and then the
/// direction and the triangle aimed at (else -1). Numbers: place on a facet, its choice, and
/// whether.
SHARED bool guide_draw(Point v, Aims aims, vec3 back, uint from, float u0, float u1, float u2,
                       float u3, OUT(vec3) w, OUT(int) triangle) MEMBER_CONST {
  triangle = -1;
  w = vec3(0.0f);
  if (!scene_has_portals || !guide_active) return false;
  float W = guide_aim_of(aims, back, from);
  if (!(W > 0.0f)) return false;
  float q = guide_chance(from, v, back);
  if (!(u3 < q) || !(u3 < q * guide_odds(v, back).broad)) return false;
  triangle = portal_aim(v.position, aims.facing, from, W, u0, u1, u2, w);
  return true;
}

/// Whether the walk that leaves y_0 is directed, and then its ray and the triangle aimed at (else
/// -1).
SHARED bool guide_leave(Point y0, Aims aims, float u0, float u1, float u2, float u3,
                        INOUT(vec3) origin, INOUT(vec3) direction, OUT(int) triangle) MEMBER_CONST {
  triangle = -1;
  if (!scene_has_portals || !guide_active) return false;
  if (!source_at_infinity(y0.source)) {
    vec3 w = vec3(0.0f);
    if (!guide_draw(y0, aims, vec3(0.0f), FROM_LIGHT, u0, u1, u2, u3, w, triangle)) return false;
    origin = y0.position;
    direction = w;
    return true;
  }
  if (!(aims.emitted > 0.0f && u3 < render.guide_light)) return false;
  vec3 at = vec3(0.0f);
  triangle = portal_aim_along(direction, aims.emitted, u0, u1, u2, at);
  origin = before_the_scene(at, direction);
  return true;
}

/// q where a walk scatters, at an albedo.
SHARED float guide_chance_at(uint from, float albedo) MEMBER_CONST {
  return min(guide_first_chance(from), 0.4f * (1.0f - albedo));
}

/// Of a walk that leaves along an edge with this crossing: the guided density [1/canonical area]
/// from the plain one. W: of what it may aim at; q: that it aims, scope: Odds of where it scatters;
/// per_area: |cos| / d^2 at the edge's other end.
SHARED float guided_pdf_A(uint from, float W, float q, OF_FLOAT(Odds) scope, float plain_A,
                          float per_area, Crossing crossing) MEMBER_CONST {
  if (!(plain_A > 0.0f && guide_first_chance(from) > 0.0f && W > 0.0f)) return plain_A;
  float by_surface = (1.0f - q * scope.broad) * plain_A;
  // What the infinite ray crosses.
  float towards = from == FROM_LIGHT ? crossing.from_light : crossing.from_camera;
  if (towards == 0.0f) return by_surface;
  float share = q * reciprocal(W) * (scope.broad * (1.0f - scope.dirac));
  return by_surface + share * towards * per_area;
}
/// The same at a point that the walk came to from unit `back`, or begins at (0).
SHARED float guided_pdf_A(uint from, Point at, Aims aims, vec3 back, float plain_A, float per_area,
                          Crossing crossing) MEMBER_CONST {
  return guided_pdf_A(from, guide_aim_of(aims, back, from), guide_chance(from, at, back),
                      guide_odds(at, back), plain_A, per_area, crossing);
}

#include "shaders/shared/language_end.h"
