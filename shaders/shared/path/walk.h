// The sub-paths of bidirectional path tracing, a vertex at a time: walks from the camera and from
// lights, each vertex with its throughput, its density from this end, and that which a walk from
// the other end would have given it. Section 3.1.2; tools/tdpt-render/path/walk.cpp.
//
// Read behind samples.h, rays.h and guide.h, where path_vertices[], path_densities[], walk_counts[]
// and walk_last[] are.

#include "shaders/shared/language.h"

SHARED Point point_in_sky(vec3 towards) MEMBER_CONST {
  Point p = empty_point();
  p.position = -towards;
  p.source = SOURCE_SKY;
  p.in_sky = look_at_sky(towards);
  p.connectible = false;
  return p;
}

/// A place on a light. An emitter that is not opaque shines by its coverage: no ray decides here
/// whether it is there.
SHARED Point point_on_light(uint source, uint triangle, float b1, float b2, vec3 position,
                            InSky in_sky) MEMBER_CONST {
  Point p = empty_point();
  if (triangle != kNoTriangle) {
    place_on_surface(triangle, b1, b2, p);
    if (scene_has_coverage) p.emission = p.emission * coverage_at(triangle, b1, b2);
    p.connectible = true;
  } else {
    p.position = position;
    p.in_sky = in_sky;
  }
  p.source = source;
  return p;
}

/// The point of a vertex, from its record.
SHARED Point point_of(PathVertex v) MEMBER_CONST {
  bool begins = is_zero(v.back);
  if (v.triangle != kNoTriangle && !begins) {
    Point p;
    place_on_surface(v.triangle, v.b1, v.b2, p);
    return p;
  }
  if (v.source == SOURCE_SKY && !begins) return point_in_sky(-v.position);
  InSky in_sky;
  in_sky.radiance = vec3(0.0f, 0.0f, 0.0f);
  in_sky.plain_w = 0.0f;
  in_sky.start_w = 0.0f;
  if (scene_has_sky && v.source == SOURCE_SKY) in_sky = look_at_sky(-v.position);
  return point_on_light(v.source, v.triangle, v.b1, v.b2, v.position, in_sky);
}

/// What leaves a point along unit w; black where no light begins.
SHARED vec3 emitted(Point p, vec3 w) MEMBER_CONST {
  if (p.source == SOURCE_NONE) return vec3(0.0f, 0.0f, 0.0f);
  vec3 light = source_radiance(p.source, p.normal, p.emission, p.in_sky, w);
  if (scene_has_coats && !p.simple && p.bsdf.coat.strength > 0.0f)
    light = light * emission_under_coat(p, w);
  return light;
}

SHARED Aims aims_of(PathVertex v) MEMBER_CONST {
  Aims aims;
  aims.facing = v.facing;
  aims.from_light = v.aims_light;
  aims.from_camera = v.aims_camera;
  aims.emitted = v.aims_emitted;
  return aims;
}
SHARED Outlook outlook_of(PathVertex v) MEMBER_CONST {
  Outlook o;
  o.facing = v.facing;
  o.seen = v.seen;
  o.sent = v.sent;
  return o;
}

/// Density of the walk from `from` at `at`, which came from unit `back` (0: it begins there) and
/// leaves with density pdf_w along an edge; per_area: |cos| / d^2 at the edge's other end.
SHARED float walk_pdf_A(uint from, Point at, Aims aims, vec3 back, float pdf_w, float per_area,
                        Crossing crossing) MEMBER_CONST {
  float plain_A = pdf_w * per_area;
  if (!scene_has_portals || !guide_active) return plain_A;
  return guided_pdf_A(from, at, aims, back, plain_A, per_area, crossing);
}
/// The same of a walk that scatters or begins at `at`, by no Dirac lobe.
SHARED float onward_pdf_A(uint from, Point at, Aims aims, vec3 back, Edge e, float per_area,
                          Crossing crossing) MEMBER_CONST {
  float pdf_w = is_zero(back) ? emission_pdf_w(at.source, at.normal, e.w)
                              : scatter_pdf_w(at, back, e.w, false);
  return walk_pdf_A(from, at, aims, back, pdf_w, per_area, crossing);
}

SHARED uint number_of(PathDensity d) MEMBER_CONST {
  return d.flags & VERTEX_NUMBER;
}
SHARED uint flags_of(Point p, uint number) MEMBER_CONST {
  uint flags = number | VERTEX_THERE;
  if (p.connectible) flags |= VERTEX_CONNECTIBLE;
  if (is_met(p)) flags |= VERTEX_MET;
  if (at_infinity(p)) flags |= VERTEX_INFINITE;
  return flags;
}

SHARED Crossing crossing_of(uint from, Point at, Point to, Drawn drawn) MEMBER {
  if (!scene_has_portals) return no_crossing();
  count_ray(RAYS_PORTAL);
  if (from == FROM_LIGHT) return edge_crossing(at, to, drawn);
  return edge_crossing(to, at, drawn);
}

/// How a walk leaves its last vertex.
struct Leaving {
  vec3 w;
  vec3 throughput;  ///< of a walk that is not directed
  bool dirac;
  bool by_film;  ///< it leaves the camera
  Drawn drawn;   ///< of the portals, aimed at
};

/// Extends a walk whose last vertex is `v`, in slot `here` (of the camera itself: kNoVertex), into
/// slot `next`. `at`: record of v.
SHARED void extend(uint from, Point v, PathVertex at, PathDensity known, uint here, vec3 origin,
                   Leaving leaving, uint next) MEMBER {
  count_ray(RAYS_CLOSEST);
  SurfaceHit hit;
  bool met = leaving.by_film ? first_drawn(origin, leaving.w, hit)
                             : first_hit(origin, leaving.w, ray_coin(origin, leaving.w), hit);
  if (!met && (from == FROM_LIGHT || !scene_has_sky)) return;
  Point to;
  if (met)
    place_on_surface(hit.triangle, hit.b1, hit.b2, to);
  else
    to = point_in_sky(leaving.w);
  Edge e = edge_between(v, to);
  if (met && !at_infinity(v) && !(e.d2 > 1e-30f)) return;
  float per_area = cosine_to(to, e.w) * reciprocal(e.d2);
  bool begins = is_zero(at.back);
  float pdf_w = leaving.by_film ? camera_pdf_w(leaving.w)
                : begins        ? emission_pdf_w(v.source, v.normal, e.w)
                                : scatter_pdf_w(v, at.back, e.w, leaving.dirac);
  float plain_A = pdf_w * per_area;
  if (!(plain_A > 0.0f)) return;

  uint number = here == kNoVertex ? 1u : number_of(known) + 1u;
  Drawn drawn = leaving.drawn;
  Crossing crossing = crossing_of(from, v, to, drawn);
  float presence = met && scene_has_panes ? presence_at(hit.triangle, leaving.w) : 1.0f;
  vec3 throughput = leaving.throughput;
  if (presence < 1.0f) throughput = throughput * reciprocal(presence);
  if (scene_has_absorption && met) throughput = throughput * transmittance(v, to, e.w, root(e.d2));
  float own = plain_A;
  bool plain = leaving.dirac || leaving.by_film;
  if (!plain) {
    own = walk_pdf_A(from, v, aims_of(at), at.back, pdf_w, per_area, crossing);
    throughput = throughput * (plain_A * reciprocal(own));
  }

  // What the vertex here, and the one before it, learn.
  if (number > 1u) {
    path_densities[here].other_survival = albedo_at(v, e.w);
    if (leaving.dirac) path_densities[here].flags = known.flags | VERTEX_DIRAC;
    if (known.prev != kNoVertex && (path_densities[known.prev].flags & VERTEX_MET) != 0u) {
      float reverse_w = scatter_pdf_w(v, e.w, at.back, leaving.dirac);
      Crossing last = crossing;
      last.from_light = at.from_light;
      last.from_camera = at.from_camera;
      uint other_end = from == FROM_LIGHT ? FROM_CAMERA : FROM_LIGHT;
      path_densities[known.prev].other_A =
          plain ? reverse_w * at.per_prev
                : walk_pdf_A(other_end, v, aims_of(at), e.w, reverse_w, at.per_prev, last);
    }
  }

  PathVertex record;
  record.position = to.position;
  record.triangle = to.triangle;
  record.back = -e.w;
  record.b1 = met ? hit.b1 : 0.0f;
  record.throughput = throughput;
  record.b2 = met ? hit.b2 : 0.0f;
  record.facing = guide_facing(to, -e.w);
  record.per_prev = cosine_to(v, e.w) * reciprocal(e.d2);
  Aims aims;
  aims.facing = record.facing;
  aims.from_light = 0.0f;
  aims.from_camera = 0.0f;
  aims.emitted = 0.0f;
  if (scene_has_portals && guide_active) aims = met ? aim_at_surface(to, -e.w) : aim_at_light(to);
  record.aims_light = aims.from_light;
  record.aims_camera = aims.from_camera;
  record.aims_emitted = aims.emitted;
  Outlook outlook;
  outlook.facing = record.facing;
  outlook.seen = 0.0f;
  outlook.sent = 0.0f;
  if (has_technique(TECHNIQUE_DIRECT) && met && (from == FROM_CAMERA || number == 1u))
    look_out(to, record.facing, outlook);
  record.seen = outlook.seen;
  record.sent = outlook.sent;
  record.from_light = crossing.from_light;
  record.from_camera = crossing.from_camera;
  record.source = to.source;
  record.walk = at.walk;
  record.ordinal = at.ordinal + (number > 1u && v.connectible ? 1u : 0u);
  path_vertices[next] = record;

  PathDensity density;
  float went_on = number <= 2u ? 1.0f : known.own_survival;
  density.own_A = went_on * own;
  density.other_A = 0.0f;
  density.pair_A = scene_has_portals ? crossing.density * geometry(v, to, e) : 0.0f;
  density.nee_A = 0.0f;
  if (has_technique(TECHNIQUE_DIRECT)) {
    if (from == FROM_LIGHT && number == 1u)
      density.nee_A = next_event_pdf(to, outlook, render.through_windows, v.source, v.triangle,
                                     v.position, v.in_sky);
    if (from == FROM_CAMERA && number > 1u && to.source != SOURCE_NONE)
      density.nee_A = next_event_pdf(v, outlook_of(at), render.through_windows, to.source,
                                     to.triangle, to.position, to.in_sky);
  }
  density.own_survival = albedo_at(to, -e.w);
  density.other_survival = 1.0f;
  density.prev = here;
  density.flags = flags_of(to, number);
  path_densities[next] = density;
  if (from == FROM_LIGHT)
    walk_counts[at.walk] = record.ordinal + (to.connectible ? 1u : 0u);
  else
    walk_last[at.walk] = next;
}

SHARED PathVertex empty_vertex(uint walk) MEMBER_CONST {
  PathVertex v;
  v.position = vec3(0.0f, 0.0f, 0.0f);
  v.triangle = kNoTriangle;
  v.back = vec3(0.0f, 0.0f, 0.0f);
  v.b1 = 0.0f;
  v.throughput = vec3(1.0f, 1.0f, 1.0f);
  v.b2 = 0.0f;
  v.facing = vec3(0.0f, 0.0f, 0.0f);
  v.per_prev = 0.0f;
  v.aims_light = 0.0f;
  v.aims_camera = 0.0f;
  v.aims_emitted = 0.0f;
  v.seen = 0.0f;
  v.sent = 0.0f;
  v.from_light = 0.0f;
  v.from_camera = 0.0f;
  v.source = SOURCE_NONE;
  v.walk = walk;
  v.ordinal = 0u;
  return v;
}
SHARED PathDensity empty_density() MEMBER_CONST {
  PathDensity d;
  d.own_A = 1.0f;
  d.other_A = 0.0f;
  d.pair_A = 0.0f;
  d.nee_A = 0.0f;
  d.own_survival = 1.0f;
  d.other_survival = 1.0f;
  d.prev = kNoVertex;
  d.flags = 0u;
  return d;
}
/// Vertex z_1 of camera walk number `walk` into slot `next`.
SHARED void begin_camera_walk(uint walk, uint next) MEMBER {
  path_densities[next].flags = 0u;
  walk_last[walk] = kNoVertex;
  uint group = walk / render.per_pool;
  uint i = walk % render.per_pool;
  if (i >= samples_of_pool(pool_of_group(group))) return;
  SampleName name = sample_of_group(group, i);
  Sequence numbers = numbers_of(name, PURPOSE_FILM);
  float x = float(name.pixel % render.width) + uniform_of(numbers);
  float y = float(name.pixel / render.width) + uniform_of(numbers);
  Point camera = empty_point();
  camera.position = render.camera_position;
  Leaving leaving;
  leaving.w = camera_direction(x, y);
  leaving.throughput = vec3(1.0f, 1.0f, 1.0f);
  leaving.dirac = false;
  leaving.by_film = true;
  leaving.drawn = drawn_otherwise();
  vec3 origin = step_off(camera.position, camera.normal, leaving.w);
  extend(FROM_CAMERA, camera, empty_vertex(walk), empty_density(), kNoVertex, origin, leaving,
         next);
}

/// Vertices y_0 and y_1 of light walk number `walk`.
SHARED void begin_light_walk(uint walk, uint first, uint next) MEMBER {
  path_densities[first].flags = 0u;
  path_densities[next].flags = 0u;
  walk_counts[walk] = 0u;
  uint group = walk / render.walks_full;
  uint i = walk % render.walks_full;
  if (i >= walks_of_pool(pool_of_group(group))) return;
  Sequence numbers = numbers_of(sample_of_group(group, i), PURPOSE_LIGHT_WALK);
  float u = uniform_of(numbers);
  float v = uniform_of(numbers);
  float pick = uniform_of(numbers);
  float side = uniform_of(numbers);
  LightPlace place = sample_light(pick, u, v, side);
  Point y0 = point_on_light(place.source, place.triangle, place.b1, place.b2, place.position,
                            place.in_sky);
  PathVertex at = empty_vertex(walk);
  at.position = y0.position;
  at.triangle = place.triangle;
  at.b1 = place.b1;
  at.b2 = place.b2;
  at.source = place.source;
  float per_pdf = reciprocal(place.pdf);
  at.throughput = vec3(per_pdf, per_pdf, per_pdf);
  at.facing = source_facing(place.source, y0.normal);
  if (scene_has_portals && guide_active) at.aims_emitted = aim_at_light(y0).emitted;
  path_vertices[first] = at;
  PathDensity density = empty_density();
  density.own_A = place.pdf;
  density.flags = flags_of(y0, 0u);
  path_densities[first] = density;
  if (render.max_depth < 2u) return;

  float a = uniform_of(numbers);
  float b = uniform_of(numbers);
  float c = uniform_of(numbers);
  float d = uniform_of(numbers);
  vec3 origin;
  Leaving leaving;
  leave_light(place, a, b, origin, leaving.w);
  int triangle = -1;
  if (scene_has_portals && guide_active)
    guide_leave(y0, aims_of(at), a, b, c, d, origin, leaving.w, triangle);
  leaving.drawn = drawn_through(triangle);
  vec3 Le = emitted(y0, leaving.w);
  leaving.throughput = at.throughput * Le * cos_per_pdf_w(place.source);
  if (!(largest(leaving.throughput) > 0.0f)) return;
  leaving.dirac = false;
  leaving.by_film = false;
  extend(FROM_LIGHT, y0, at, density, first, step_off(origin, y0.normal, leaving.w), leaving, next);
}

/// Whether a walk may go on at this vertex, if the roulette lets it.
SHARED bool may_go_on(uint from, PathDensity d) MEMBER_CONST {
  uint edges = from == FROM_LIGHT ? render.max_depth - 1u : render.max_depth;
  return (d.flags & VERTEX_THERE) != 0u && (d.flags & VERTEX_INFINITE) == 0u &&
         number_of(d) < edges;
}

/// The vertex after the one in slot `here`, number 1 or above, into slot `next`.
SHARED void go_on(uint from, uint here, uint next) MEMBER {
  path_densities[next].flags = 0u;
  PathVertex at = path_vertices[here];
  PathDensity known = path_densities[here];
  uint per_group = from == FROM_LIGHT ? render.walks_full : render.per_pool;
  SampleName name = sample_of_group(at.walk / per_group, at.walk % per_group);
  Sequence numbers =
      numbers_of(name, from == FROM_LIGHT ? PURPOSE_LIGHT_WALK : PURPOSE_CAMERA_WALK);
  uint number = number_of(known);
  seek(numbers, kPerBounce * number);
  float a = uniform_of(numbers);
  float b = uniform_of(numbers);
  float lobe = uniform_of(numbers);
  float roulette = uniform_of(numbers);
  float chance = number <= 1u ? 1.0f : known.own_survival;
  if (!(roulette < chance)) return;
  Point v = point_of(at);
  Turn t;
  bool scatters = turn(v, from, at.back, a, b, lobe, t);
  Leaving leaving;
  leaving.drawn = drawn_otherwise();
  if (scene_has_portals && guide_active && !t.dirac) {
    float c = uniform_of(numbers);
    float d = uniform_of(numbers);
    float e = uniform_of(numbers);
    float f = uniform_of(numbers);
    vec3 towards;
    int triangle = -1;
    if (guide_draw(v, aims_of(at), at.back, from, c, d, e, f, towards, triangle)) {
      leaving.drawn = drawn_through(triangle);
      scatters = turn_towards(v, from, at.back, towards, t);
    }
  }
  if (!scatters) return;
  leaving.w = t.w;
  leaving.throughput = at.throughput * t.weight * reciprocal(chance);
  if (!(largest(leaving.throughput) > 0.0f)) return;
  leaving.dirac = t.dirac;
  leaving.by_film = false;
  extend(from, v, at, known, here, step_off(v.position, v.normal, t.w), leaving, next);
}

#include "shaders/shared/language_end.h"
