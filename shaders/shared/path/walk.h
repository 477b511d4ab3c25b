// The sub-paths of bidirectional path tracing, one vertex at a time: walks from the camera and from
// lights. Each vertex has its throughput, its density in this walk, and its density in a walk from
// the other end. Section 3.1.2; tools/tdpt-render/path/sample/walk.cpp.
//
// Include after film.h, rays.h and guide.h, where path_vertices[], path_bsdfs[],
// path_densities[], walk_rays[], walk_counts[], walk_last[] and `work` are, and load_x() of the
// first four.

#include "shaders/shared/language.h"

SHARED Point point_in_sky(vec3 towards) MEMBER_CONST {
  Point p = empty_point();
  p.position = -towards;
  p.source = SOURCE_SKY;
  p.in_sky = look_at_sky(towards);
  p.connectible = false;
  return p;
}

/// Stores the point of a vertex.
SHARED void keep_point(uint slot, Point p, INOUT(PathVertex) v) MEMBER {
  v.position = p.position;
  v.triangle = p.triangle;
  v.source = p.source;
  v.normal = p.normal;
  v.material = p.material;
  v.color = p.color;
  bool in_sky = p.source == SOURCE_SKY;
  v.emission = in_sky ? p.in_sky.radiance : p.emission;
  v.plain_w = p.in_sky.plain_w;
  v.made_of = (p.simple ? POINT_SIMPLE : 0u) | (p.connectible ? POINT_CONNECTIBLE : 0u);
  if (!scene_has_layers || p.simple) return;
  PathBsdf b = {p.shading, 0.0f, p.bsdf};
  path_bsdfs[slot] = b;
}
/// The stored point of a vertex. start_w of a point in the sky is not stored.
SHARED Point kept_point(uint slot, PathVertex v) MEMBER_CONST {
  Point p = empty_point();
  p.position = v.position;
  p.triangle = v.triangle;
  p.source = v.source;
  p.normal = v.normal;
  p.shading = v.normal;
  p.material = v.material;
  p.color = v.color;
  p.emission = v.emission;
  p.in_sky.radiance = v.emission;
  p.in_sky.plain_w = v.plain_w;
  p.simple = (v.made_of & POINT_SIMPLE) != 0u;
  p.connectible = (v.made_of & POINT_CONNECTIBLE) != 0u;
  if (!scene_has_layers || p.simple) return p;
  PathBsdf b = load_path_bsdf(slot);
  p.shading = b.shading;
  p.bsdf = b.bsdf;
  return p;
}

/// Emission of a point along unit w; black if no light begins there.
SHARED vec3 emitted(Point p, vec3 w) MEMBER_CONST {
  if (p.source == SOURCE_NONE) return vec3(0.0f, 0.0f, 0.0f);
  vec3 light = source_radiance(p.source, p.normal, p.emission, p.in_sky, w);
  if (scene_has_coats && !p.simple && p.bsdf.coat.strength > 0.0f)
    light = light * emission_under_coat(p, w);
  return light;
}

SHARED LightContext light_context_of(PathVertex v) MEMBER_CONST {
  LightContext o = {v.facing, v.seen, v.sent};
  return o;
}
SHARED void keep_guide_totals(INOUT(PathVertex) v, GuideTotals guide_totals) MEMBER_CONST {
  v.guide_total_light = guide_totals.from_light;
  v.guide_total_camera = guide_totals.from_camera;
  v.guide_total_emitted = guide_totals.emitted;
}

SHARED float guide_total_at_vertex(uint from, PathVertex at) MEMBER_CONST {
  return from == FROM_LIGHT ? at.guide_total_light : at.guide_total_camera;
}
/// Survival probability of a walk from `from` that scatters there, the vertex having this albedo
/// as seen from where the walk came.
SHARED float survival_where(uint from, PathVertex at, float albedo) MEMBER_CONST {
  if (!scene_has_portals || !guide_active) return albedo;
  return guided_survival(from, guide_total_at_vertex(from, at), albedo);
}
/// Scattering at a vertex of a walk from `from`; `at` is its record.
SHARED Scattering scattering_of(Point p, PathVertex at, uint from, vec3 w,
                                bool dirac) MEMBER_CONST {
  Scattering s = scattering_at(p, from, at.back, w, dirac);
  s.survival_behind =
      survival_where(from == FROM_LIGHT ? FROM_CAMERA : FROM_LIGHT, at, s.survival_behind);
  return s;
}
/// Density per area at a vertex, of the walk from `from`, from that per solid angle. `survival`,
/// `scope`: as the vertex is seen from where the walk came.
SHARED float scattered_pdf_A(uint from, PathVertex at, float survival, OF_FLOAT(Odds) scope,
                             float pdf_w, float per_area, CrossingDensity crossing) MEMBER_CONST {
  float plain_A = pdf_w * per_area;
  if (!scene_has_portals || !guide_active) return plain_A;
  float W = guide_total_at_vertex(from, at);
  return guided_pdf_A(from, W, guide_chance_at(from, survival), scope, plain_A, per_area, crossing);
}
/// The same where light leaves a point on a light.
SHARED float emitted_pdf_A(uint source, vec3 normal, float guide_total_emitted, vec3 w,
                           float per_area, CrossingDensity crossing) MEMBER_CONST {
  float plain_A = emission_pdf_w(source, normal, w) * per_area;
  if (!scene_has_portals || !guide_active) return plain_A;
  OF_FLOAT(Odds) all = {0.0f, 1.0f};
  return guided_pdf_A(FROM_LIGHT, guide_total_emitted, render.guide_light, all, plain_A, per_area,
                      crossing);
}
SHARED OF_FLOAT(Odds) odds_onward(Scattering s) MEMBER_CONST {
  OF_FLOAT(Odds) odds = {s.dirac, s.broad};
  return odds;
}
SHARED OF_FLOAT(Odds) odds_behind(Scattering s) MEMBER_CONST {
  OF_FLOAT(Odds) odds = {s.dirac_behind, s.broad_behind};
  return odds;
}
SHARED CrossingDensity crossing_before(PathVertex v) MEMBER_CONST {
  CrossingDensity c = no_crossing();
  c.from_light = v.from_light;
  c.from_camera = v.from_camera;
  return c;
}

SHARED uint number_of(PathDensity d) MEMBER_CONST {
  return d.flags & VERTEX_NUMBER;
}
SHARED uint flags_of(Point p, uint number) MEMBER_CONST {
  uint flags_here = number | VERTEX_THERE;
  if (p.connectible) flags_here |= VERTEX_CONNECTIBLE;
  if (is_met(p)) flags_here |= VERTEX_MET;
  if (at_infinity(p)) flags_here |= VERTEX_INFINITE;
  return flags_here;
}

SHARED CrossingDensity crossing_of(uint from, Point at, Point to, Drawn drawn) MEMBER {
  if (!scene_has_portals) return no_crossing();
  count_ray(RAYS_PORTAL);
  Point light = at;
  Point camera = to;
  if (from == FROM_CAMERA) {
    light = to;
    camera = at;
  }
  return edge_crossing(light, camera, drawn);
}

SHARED PathVertex empty_vertex(uint walk) MEMBER_CONST {
  PathVertex v = zero_PathVertex();
  v.triangle = kNoTriangle;
  v.throughput = vec3(1.0f, 1.0f, 1.0f);
  v.walk = walk;
  v.made_of = POINT_SIMPLE | POINT_CONNECTIBLE;
  return v;
}
SHARED PathDensity empty_density() MEMBER_CONST {
  PathDensity d = {1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 1.0f, kNoVertex, 0u};
  return d;
}
SHARED WalkRay no_ray(uint walk) MEMBER_CONST {
  WalkRay ray = zero_WalkRay();
  ray.here = kNoVertex;
  ray.w = vec3(0.0f, 0.0f, 1.0f);
  ray.throughput = vec3(1.0f, 1.0f, 1.0f);
  ray.polygon = -1;
  ray.triangle = kNoTriangle;
  ray.walk = walk;
  return ray;
}

/// An emitter that is not opaque shines in proportion to its coverage, since no ray decides here
/// whether it is hit.
SHARED Point point_on_light(LightPlace place) MEMBER_CONST {
  Point p = empty_point();
  if (place.triangle != kNoTriangle) {
    place_on_surface(place.triangle, place.b1, place.b2, p);
    if (scene_has_coverage)
      p.emission = p.emission * coverage_at(place.triangle, place.b1, place.b2);
    p.connectible = true;
  } else {
    p.position = place.position;
    p.in_sky = place.in_sky;
  }
  p.source = place.source;
  return p;
}

/// The ray of camera walk number `walk` through the film.
SHARED void begin_camera_walk(uint walk) MEMBER {
  walk_last[walk] = kNoVertex;
  WalkRay ray = no_ray(walk);
  uint group = walk / render.per_cache;
  uint i = walk % render.per_cache;
  if (i < samples_of_cache(cache_of_group(group))) {
    SampleName name = sample_of_group(group, i);
    Sequence numbers = numbers_of(name, PURPOSE_FILM);
    float x = float(name.pixel % render.width) + uniform_of(numbers);
    float y = float(name.pixel / render.width) + uniform_of(numbers);
    ray.w = camera_direction(x, y);
    ray.origin = step_off(render.camera_position, vec3(0.0f, 0.0f, 0.0f), kNoTriangle, ray.w);
    ray.flags = RAY_THERE | RAY_BY_FILM;
  }
  walk_rays[walk] = ray;
}

/// Vertex y_0 of light walk number `walk`, to slot `slot`, and the ray that leaves it.
SHARED void begin_light_walk(uint walk, uint slot) MEMBER {
  if (walk == 0u) walk_counts[work.count] = 0u;  // the place of their sum
  path_densities[slot].flags = 0u;
  walk_counts[walk] = 0u;
  walk_rays[walk] = no_ray(walk);
  uint group = walk / render.walks_full;
  uint i = walk % render.walks_full;
  if (i >= walks_of_cache(cache_of_group(group))) return;
  Sequence numbers = numbers_of(sample_of_group(group, i), PURPOSE_LIGHT_WALK);
  FourNumbers n = four_numbers_of(numbers);
  LightPlace place = sample_light(n.c, n.a, n.b, n.d);
  Point y0 = point_on_light(place);
  PathVertex at = empty_vertex(walk);
  keep_point(slot, y0, at);
  float per_pdf = reciprocal(place.pdf);
  at.throughput = vec3(per_pdf, per_pdf, per_pdf);
  at.facing = source_facing(place.source, y0.normal);
  GuideTotals guide_totals = guide_totals_at_light(y0);
  keep_guide_totals(at, guide_totals);
  path_vertices[slot] = at;
  PathDensity density = empty_density();
  density.own_A = place.pdf;
  density.flags = flags_of(y0, 0u);
  path_densities[slot] = density;
  if (render.max_depth < 2u) return;

  n = four_numbers_of(numbers);
  WalkRay ray = no_ray(walk);
  vec3 origin;
  leave_light(place, n.a, n.b, origin, ray.w);
  guide_leave(y0, guide_totals, n.a, n.b, n.c, n.d, origin, ray.w, ray.polygon);
  ray.throughput = at.throughput * emitted(y0, ray.w) * cos_per_pdf_w(place.source, ray.w);
  if (!(largest(ray.throughput) > 0.0f)) return;
  ray.here = slot;
  if (at_infinity(y0) && scene_reach() > 2.0f)
    origin = before_the_origin(origin, ray.w, 2.0f * scene_reach());
  ray.origin = step_off(origin, y0.normal, y0.triangle, ray.w);
  ray.flags = RAY_THERE;
  walk_rays[walk] = ray;
}

SHARED Sequence numbers_of_walk(uint from, uint walk) MEMBER_CONST {
  uint per_group = from == FROM_LIGHT ? render.walks_full : render.per_cache;
  SampleName name = sample_of_group(walk / per_group, walk % per_group);
  return numbers_of(name, from == FROM_LIGHT ? PURPOSE_LIGHT_WALK : PURPOSE_CAMERA_WALK);
}
/// Survival probability of a walk at a vertex.
SHARED float chance_to_go_on(PathDensity d) MEMBER_CONST {
  return number_of(d) <= 1u ? 1.0f : d.own_survival;
}
/// Whether a walk survives at the vertex in a slot.
SHARED bool goes_on(uint from, uint slot) MEMBER_CONST {
  PathDensity d = load_path_density(slot);
  uint edges = from == FROM_LIGHT ? render.max_depth - 1u : render.max_depth;
  if ((d.flags & VERTEX_THERE) == 0u || (d.flags & VERTEX_INFINITE) != 0u) return false;
  if (number_of(d) >= edges) return false;
  Sequence numbers = numbers_of_walk(from, load_path_vertex(slot).walk);
  seek(numbers, kPerBounce * number_of(d) + 3u);
  return uniform_of(numbers) < chance_to_go_on(d);
}

/// Samples the next direction of a walk, by the BSDF or by guiding. u: direction, lobe; aim: as in
/// guide_draw().
SHARED bool directed_turn(uint from, Point p, PathVertex at, float survival, FourNumbers u,
                          FourNumbers aim, OUT(OF_FLOAT(Turn)) t, OUT(int) polygon) MEMBER_CONST {
  polygon = -1;
  t.dirac = false;
  t.weight = p.color;
  t.w = at.back;
  float W = guide_total_at_vertex(from, at);
  float q = guide_active && W > 0.0f ? guide_chance_at(from, survival) : 0.0f;
  if (!is_layered(p)) {
    if (scene_has_portals && guide_active && aim.d < q) {
      polygon = draw_towards_portal(p.position, at.facing, from, W, aim.a, aim.b, aim.c, t.w);
      return same_side(p, at.back, t.w);
    }
    return simple_turn(p, at.back, u.a, u.b, t);
  }
  ScatterContext here = scatter_context_at(p, at.back);
  vec3 to;
  bool by_coat;
  bool turned = coated_turn(p, here, u.a, u.b, u.c, to, t.dirac, by_coat);
  bool guided = false;
  if (scene_has_portals && guide_active && aim.d < q && !t.dirac)
    guided = aim.d < q * coated_odds(p, here).broad;
  if (guided)
    polygon = draw_towards_portal(p.position, at.facing, from, W, aim.a, aim.b, aim.c, t.w);
  else if (turned)
    t.w = normalized(to_world(onb_about(p.shading), to));
  else
    return false;
  Seen next = seen_from(p, t.w);
  // Bent normals may send it to a side where its lobe is not visible.
  if (!guided && !(by_coat ? both_on_coat(here.seen, next) : next.on_base)) return false;
  return weigh(p, from, here, next, t.dirac, t.weight);
}

/// The ray that leaves the vertex in slot `here`, number 1 or above, of a walk that continues.
SHARED void go_on(uint from, uint here, uint i) MEMBER {
  PathVertex at = load_path_vertex(here);
  PathDensity known = load_path_density(here);
  walk_rays[i] = no_ray(at.walk);
  Sequence numbers = numbers_of_walk(from, at.walk);
  seek(numbers, kPerBounce * number_of(known));
  FourNumbers u = four_numbers_of(numbers);  // the last one has decided that the walk continues
  FourNumbers aim = {0.0f, 0.0f, 0.0f, 0.0f};
  if (scene_has_portals && guide_active) aim = four_numbers_of(numbers);
  Point p = kept_point(here, at);
  OF_FLOAT(Turn) t;
  WalkRay ray = no_ray(at.walk);
  if (!directed_turn(from, p, at, known.own_survival, u, aim, t, ray.polygon)) return;
  ray.w = t.w;
  ray.throughput = at.throughput * t.weight * reciprocal(chance_to_go_on(known));
  if (!(largest(ray.throughput) > 0.0f)) return;
  ray.here = here;
  ray.origin = step_off(p.position, p.normal, p.triangle, t.w);
  ray.flags = RAY_THERE | (t.dirac ? RAY_DIRAC : 0u);
  walk_rays[i] = ray;
}

/// Whether a ray that hits a triangle near one of its edges was stopped before by a neighbour;
/// moves the hit off the edge.
SHARED bool stopped_at_edge(WalkRay ray, INOUT(SurfaceHit) hit) MEMBER_CONST {
  Face face = load_face(hit.triangle);
  if (!keep_off_edges(face.e1, face.e2, ray.w, hit.b1, hit.b2)) return false;
  if (camera_culls && (ray.flags & RAY_BY_FILM) != 0u) return false;
  vec3 position = face.p0 + face.e1 * hit.b1 + face.e2 * hit.b2;
  vec3 way = position - ray.origin;
  vec3 from = ray.origin + ray.w * max(root(dot(way, way)) - kEdgeReach, 0.0f);
  return segment_blocked(from, step_off(position, face.normal, hit.triangle, -ray.w),
                         ray_coin(ray.origin, ray.w));
}

/// Finds what the ray of a walk hits.
SHARED void trace_ray(uint i) MEMBER {
  WalkRay ray = load_walk_ray(i);
  if ((ray.flags & RAY_THERE) == 0u) return;
  count_ray(RAYS_CLOSEST);
  SurfaceHit hit;
  bool met = first_met(ray.origin, ray.w, (ray.flags & RAY_BY_FILM) != 0u, hit);
  if (met && stopped_at_edge(ray, hit)) walk_rays[i].flags = 0u;
  walk_rays[i].triangle = met ? hit.triangle : kNoTriangle;
  walk_rays[i].b1 = hit.b1;
  walk_rays[i].b2 = hit.b2;
}

/// Density per area of the vertex that a ray has reached along w from v (`at`, `known`). plain_A:
/// the same for an unguided walk; if it is 0 the walk ends. If the walk scattered at v, the
/// densities of a walk from the other end are stored for v and the vertex before it.
SHARED float arrival_pdf_A(uint from, WalkRay ray, Point v, PathVertex at, PathDensity known,
                           vec3 w, float per_area, CrossingDensity crossing,
                           OUT(float) plain_A) MEMBER {
  if ((ray.flags & RAY_BY_FILM) != 0u) {
    plain_A = camera_pdf_w(ray.w) * per_area;
    return plain_A;
  }
  if (is_zero(at.back)) {
    plain_A = emission_pdf_w(v.source, v.normal, w) * per_area;
    return emitted_pdf_A(v.source, v.normal, at.guide_total_emitted, w, per_area, crossing);
  }
  bool dirac = (ray.flags & RAY_DIRAC) != 0u;
  Scattering s = scattering_of(v, at, from, w, dirac);
  plain_A = s.onward_w * per_area;
  float own_A = plain_A;
  float other_A = s.behind_w * at.per_prev;
  if (!dirac) {
    own_A = scattered_pdf_A(from, at, known.own_survival, odds_onward(s), s.onward_w, per_area,
                            crossing);
    uint other_end = from == FROM_LIGHT ? FROM_CAMERA : FROM_LIGHT;
    other_A = scattered_pdf_A(other_end, at, s.survival_behind, odds_behind(s), s.behind_w,
                              at.per_prev, crossing_before(at));
  }
  if (!(plain_A > 0.0f)) return own_A;
  path_densities[ray.here].other_survival = s.survival_behind;
  if (dirac) path_densities[ray.here].flags = known.flags | VERTEX_DIRAC;
  if (known.prev != kNoVertex && (load_path_density(known.prev).flags & VERTEX_MET) != 0u)
    path_densities[known.prev].other_A = other_A;
  return own_A;
}

/// The point that a ray has reached.
SHARED Point point_reached(WalkRay ray) MEMBER_CONST {
  if (ray.triangle == kNoTriangle) return point_in_sky(ray.w);
  Point p;
  place_on_surface(ray.triangle, ray.b1, ray.b2, p);
  return p;
}
/// The vertex there, `back` from it, without what depends on the vertex before. looks_out: next
/// events may be made there.
SHARED PathVertex vertex_reached(uint slot, WalkRay ray, Point p, vec3 back,
                                 bool looks_out) MEMBER {
  PathVertex v = empty_vertex(ray.walk);
  keep_point(slot, p, v);
  v.back = back;
  v.facing = guide_facing(p, back);
  if (scene_has_portals && guide_active) {
    if (ray.triangle != kNoTriangle)
      keep_guide_totals(v, guide_totals_at_surface(p, back));
    else
      keep_guide_totals(v, guide_totals_at_light(p));
  }
  LightContext light_context = light_context_of(v);
  if (looks_out) look_out(p, v.facing, light_context);
  v.seen = light_context.seen;
  v.sent = light_context.sent;
  return v;
}

/// Density of the light point at one end of an edge as a next event from the other end; 0 if
/// neither is on a light. The edge goes from v to vertex `number` of its walk.
SHARED float edge_nee_A(uint from, uint number, Point v, PathVertex at_v, Point to,
                        PathVertex at_to) MEMBER_CONST {
  bool from_y0 = from == FROM_LIGHT && number == 1u;
  bool to_x0 = from == FROM_CAMERA && number > 1u && to.source != SOURCE_NONE;
  if (!has_technique(TECHNIQUE_DIRECT) || !(from_y0 || to_x0)) return 0.0f;
  Point lit = to;
  Point light = v;
  LightContext light_context = light_context_of(at_to);
  if (to_x0) {
    lit = v;
    light = to;
    light_context = light_context_of(at_v);
  }
  return next_event_pdf(lit, light_context, render.through_windows, light.source, light.triangle,
                        light.position, light.in_sky);
}

/// Stores the vertex that the ray of a walk has reached, in slot `next`.
SHARED void arrive(uint from, uint i, uint next) MEMBER {
  path_densities[next].flags = 0u;
  WalkRay ray = load_walk_ray(i);
  bool met = ray.triangle != kNoTriangle;
  if ((ray.flags & RAY_THERE) == 0u) return;
  if (!met && (from == FROM_LIGHT || !scene_has_sky)) return;
  Point v = empty_point();
  v.position = render.camera_position;
  PathVertex at = empty_vertex(ray.walk);
  PathDensity known = empty_density();
  bool by_film = (ray.flags & RAY_BY_FILM) != 0u;
  if (!by_film) {
    at = load_path_vertex(ray.here);
    known = load_path_density(ray.here);
    v = kept_point(ray.here, at);
  }
  uint number = by_film ? 1u : number_of(known) + 1u;
  Point to = point_reached(ray);
  Edge e = edge_between(v, to);
  if (met && !at_infinity(v) && !(e.d2 > 1e-30f)) return;
  float per_area = cosine_to(to, e.w) * reciprocal(e.d2);
  Drawn drawn = drawn_through(ray.polygon);
  CrossingDensity crossing = crossing_of(from, v, to, drawn);
  float plain_A;
  float own_A = arrival_pdf_A(from, ray, v, at, known, e.w, per_area, crossing, plain_A);
  if (!(plain_A > 0.0f)) return;

  vec3 throughput = ray.throughput * (plain_A * reciprocal(own_A));
  float opacity = met && scene_has_panes ? opacity_at(ray.triangle, ray.w) : 1.0f;
  if (opacity < 1.0f) throughput = throughput * reciprocal(opacity);
  bool looks_out = has_technique(TECHNIQUE_DIRECT) && met && (from == FROM_CAMERA || number == 1u);
  PathVertex record = vertex_reached(next, ray, to, -e.w, looks_out);
  record.per_prev = cosine_to(v, e.w) * reciprocal(e.d2);
  record.from_light = crossing.from_light;
  record.from_camera = crossing.from_camera;
  record.throughput = absorbed(throughput, v, to, e);
  record.ordinal = at.ordinal + (number > 1u && v.connectible ? 1u : 0u);
  path_vertices[next] = record;

  PathDensity density = empty_density();
  density.own_A = (number <= 2u ? 1.0f : known.own_survival) * own_A;
  density.pair_A = scene_has_portals ? crossing.density * geometry(v, to, e) : 0.0f;
  density.nee_A = edge_nee_A(from, number, v, at, to, record);
  density.own_survival = survival_where(from, record, albedo_at(to, -e.w));
  density.prev = ray.here;
  density.flags = flags_of(to, number);
  path_densities[next] = density;
  if (from == FROM_LIGHT)
    walk_counts[ray.walk] = record.ordinal + (to.connectible ? 1u : 0u);
  else
    walk_last[ray.walk] = next;
}

#include "shaders/shared/language_end.h"
