// Test only: trials of portals.h and guide.h on random edges, as words, to compare a device with
// C++. Include after portals.h; the surfaces and lights that guide.h needs are invented here.

#include "shaders/shared/language.h"

SHARED bool source_met(uint source) MEMBER_CONST {
  return source < SOURCE_LAMPS;
}
SHARED bool source_at_infinity(uint source) MEMBER_CONST {
  return source == SOURCE_SKY || source == SOURCE_LAMPS + 1u;
}
SHARED vec3 source_facing(uint source, vec3 normal) MEMBER_CONST {
  return source == SOURCE_FRONT ? normal : vec3(0.0f);
}
/// For points that are not simple: made from members that nothing else here uses.
SHARED float albedo_at(Point p, vec3 back) MEMBER_CONST {
  float layered = min(p.bsdf.sheen_alpha + 0.1f * abs(dot(p.normal, back)), 1.0f);
  return p.simple ? min(max(largest(p.color), 0.05f), 1.0f) : layered;
}
SHARED OF_FLOAT(Odds) odds_at(Point p, vec3 back) MEMBER_CONST {
  OF_FLOAT(Odds) odds;
  odds.dirac = p.bsdf.coat.strength;
  odds.broad = p.bsdf.coat.alpha * abs(dot(p.normal, back));
  return odds;
}

#include "shaders/shared/language_end.h"

#include "shaders/shared/path/guide.h"

#include "shaders/shared/language.h"

SHARED float trial_number(INOUT(Rng) rng) MEMBER_CONST {
  return unit_float(random_word(rng));
}
SHARED vec3 trial_place(INOUT(Rng) rng) MEMBER_CONST {
  float x = 2.0f * trial_number(rng) - 1.0f;
  float y = 2.0f * trial_number(rng) - 1.0f;
  float z = 2.0f * trial_number(rng) - 1.0f;
  return vec3(x, y, z);
}
SHARED Point trial_point(INOUT(Rng) rng) MEMBER_CONST {
  Point p;
  p.position = trial_place(rng);
  p.normal = normalized(trial_place(rng));
  p.shading = p.normal;
  p.triangle = random_word(rng) & 0xFFu;
  p.material = 0u;
  p.source = random_word(rng) & 7u;
  p.source = p.source > SOURCE_LAMPS + 1u ? SOURCE_NONE : p.source;
  p.simple = trial_number(rng) < 0.5f;
  p.connectible = trial_number(rng) < 0.9f;
  float color = trial_number(rng);
  p.color = vec3(color, 0.5f * color, 0.0f);
  p.emission = vec3(0.0f);
  p.bsdf.through = vec3(trial_number(rng) < 0.5f ? 0.0f : 0.5f);
  p.bsdf.sheen_alpha = trial_number(rng);
  p.bsdf.coat.strength = trial_number(rng);
  p.bsdf.coat.alpha = trial_number(rng);
  if (source_at_infinity(p.source)) p.position = p.normal;
  if (p.source >= SOURCE_SKY) p.triangle = kNoTriangle;
  return p;
}

SHARED void tell(INOUT(PortalTrial) trial, float x) MEMBER_CONST {
  trial.words[trial.told] = floatBitsToUint(x);
  trial.told += 1u;
}
SHARED void tell(INOUT(PortalTrial) trial, int x) MEMBER_CONST {
  trial.words[trial.told] = uint(x);
  trial.told += 1u;
}
SHARED void tell(INOUT(PortalTrial) trial, vec3 v) MEMBER_CONST {
  tell(trial, v.x);
  tell(trial, v.y);
  tell(trial, v.z);
}
SHARED void tell(INOUT(PortalTrial) trial, CrossingDensity c) MEMBER_CONST {
  tell(trial, c.density);
  tell(trial, c.from_light);
  tell(trial, c.from_camera);
}

SHARED SegmentDraw trial_segment(INOUT(Rng) rng) MEMBER_CONST {
  float u0 = trial_number(rng);
  float u1 = trial_number(rng);
  float u2 = trial_number(rng);
  float u3 = trial_number(rng);
  float u4 = trial_number(rng);
  float u5 = trial_number(rng);
  float u6 = trial_number(rng);
  return sample_segment(u0, u1, u2, u3, u4, u5, u6);
}

// Segments, and arbitrary edges.
SHARED void try_segments(INOUT(Rng) rng, INOUT(PortalTrial) trial) MEMBER_CONST {
  SegmentDraw s = trial_segment(rng);
  tell(trial, s.drawn.polygon);
  tell(trial, s.drawn.second);
  tell(trial, s.position);
  tell(trial, s.direction);
  tell(trial, segment_start(s));
  float before = trial_number(rng);
  float after = trial_number(rng);
  vec3 x_l = s.position - s.direction * before;
  vec3 x_c = s.position + s.direction * after;
  tell(trial, segment_spans(s.drawn, x_l, x_c) ? 1 : 0);
  tell(trial, portal_crossing(x_l, x_c, s.drawn));
  tell(trial, portal_density(x_l, x_c, drawn_otherwise()));
  vec3 a = trial_place(rng);
  vec3 b = trial_place(rng);
  tell(trial, portal_crossing(a, b, drawn_otherwise()));
  tell(trial, coverage_along(s.direction, x_c, drawn_through(s.drawn.polygon)));
}

// Guided walks.
SHARED void try_walks(INOUT(Rng) rng, INOUT(PortalTrial) trial) MEMBER_CONST {
  Point at = trial_point(rng);
  Point to = trial_point(rng);
  vec3 away = normalized(trial_place(rng));
  vec3 back = trial_number(rng) < 0.3f ? vec3(0.0f) : away;
  uint from = is_zero(back) ? FROM_LIGHT : random_word(rng) & 1u;
  GuideTotals guide_totals = guide_totals_at_surface(at, away);
  if (is_zero(back)) guide_totals = guide_totals_at_light(at);
  tell(trial, guide_totals.facing);
  tell(trial, guide_totals.from_light);
  tell(trial, guide_totals.from_camera);
  tell(trial, guide_totals.emitted);
  float u0 = trial_number(rng);
  float u1 = trial_number(rng);
  float u2 = trial_number(rng);
  float u3 = trial_number(rng);
  vec3 w;
  vec3 origin = at.position;
  int triangle;
  bool directed;
  if (is_zero(back)) {
    w = at.position;
    directed = guide_leave(at, guide_totals, u0, u1, u2, u3, origin, w, triangle);
  } else {
    directed = guide_draw(at, guide_totals, back, from, u0, u1, u2, u3, w, triangle);
  }
  tell(trial, directed ? 1 : 0);
  tell(trial, triangle);
  tell(trial, w);
  tell(trial, origin);
  if (directed) to.position = origin + w * 0.7f;
  CrossingDensity c;
  if (from == FROM_LIGHT)
    c = edge_crossing(at, to, drawn_through(triangle));
  else
    c = edge_crossing(to, at, drawn_through(triangle));
  tell(trial, c);
  Edge e;
  e.w = w;
  e.d2 = 0.49f;
  tell(trial,
       guided_pdf_A(from, at, guide_totals, back, 0.3f, cosine_to(to, e.w) * reciprocal(e.d2), c));
}

/// The results of invocation i.
SHARED PortalTrial try_portals(uint i) MEMBER_CONST {
  PortalTrial trial;
  trial.told = 0u;
  Rng rng = rng_of(word64_of(0u, 21u), word64_of(0u, 4u), word64_of(0u, i), word64_of(0u, 0u));
  try_segments(rng, trial);
  try_walks(rng, trial);
  return trial;
}

#include "shaders/shared/language_end.h"
