// Portal segments: drawn and joined with the light's side, then with the camera's. Sections 3.1.1
// and 3.2, tools/tdpt-render/path/segment_sampler.cpp. x_l and x_c are the ends on the light's and
// on the camera's side.
//
// Read behind connect.h, where segments[], segment_sides[] and walk_last[] are. A sample's segment
// has its number within the submission.

#include "shaders/shared/language.h"

/// One end of a segment: where a ray from the portal along unit w ends. False: nowhere of use.
SHARED bool end_segment(vec3 from, vec3 w, OUT(Point) p, INOUT(PathVertex) v,
                        INOUT(float) presence) MEMBER {
  count_ray(RAYS_CLOSEST);
  SurfaceHit hit;
  p = empty_point();
  v.back = -w;
  v.triangle = kNoTriangle;
  if (first_hit(from, w, ray_coin(from, w), hit)) {
    place_on_surface(hit.triangle, hit.b1, hit.b2, p);
    if (scene_has_panes) presence = presence * presence_at(hit.triangle, w);
    v.triangle = hit.triangle;
    v.b1 = hit.b1;
    v.b2 = hit.b2;
  } else {
    if (!scene_has_sky) return false;
    p = point_in_sky(w);
  }
  v.position = p.position;
  v.source = p.source;
  return true;
}

SHARED void keep_aims(INOUT(PathVertex) v, Aims aims) MEMBER_CONST {
  v.facing = aims.facing;
  v.aims_light = aims.from_light;
  v.aims_camera = aims.from_camera;
  v.aims_emitted = aims.emitted;
}

/// What an end of light, y_{s-1}, brings to x_l, which sends it on along w, without visibility.
SHARED vec3 brought_to(Point x_l, vec3 w, Point y, PathVertex light, Edge e) MEMBER_CONST {
  vec3 sent = is_zero(light.back) ? emitted(y, e.w) : bsdf_at(y, light.back, e.w);
  vec3 value = light.throughput * sent * bsdf_at(x_l, -e.w, w) * geometry(y, x_l, e);
  return absorbed(value, y, x_l, e);
}

SHARED JoinEnd light_candidate(uint group, uint c) MEMBER_CONST {
  uint first = first_end(group);
  uint n = first_end(group + 1u) - first;
  return join_ends[c < n ? scattered_ends() + first + c : group * render.walks_full + c - n];
}

/// The vertices of light walks that x_l, sending along w, is joined with: few of the pool's.
SHARED void join_segment_with_light(uint segment, uint group, Point x_l, vec3 w, float u,
                                    float u_few, INOUT(PortalSegment) s) MEMBER {
  uint n = first_end(group + 1u) - first_end(group) + walks_of_pool(pool_of_group(group));
  uint m = min(n, kCandidates);
  float walks = float(walks_of_pool(pool_of_group(group)));
  float times = n <= kCandidates ? walks : walks * 8.0f * reciprocal(float(n));
  vec3 one = vec3(1.0f, 1.0f, 1.0f);
  JoinEnd here = join_end(x_l, w, one, 0u, 0u);
  float total = 0.0f;
  uint not_zero = 0u;
  for (uint i = 0u; i < m; ++i) {
    JoinEnd end = light_candidate(group, candidate_of(0u, n, i, u));
    float estimate = end.number + 3u > render.max_depth ? 0.0f : estimate_join(end, here);
    total += estimate;
    not_zero += estimate > 0.0f ? 1u : 0u;
  }
  if (not_zero == 0u) return;
  bool all = not_zero <= 2u;
  float per_total = reciprocal(max(total, 1e-37f));
  float alike = 0.5f * reciprocal(float(not_zero));
  float before = u_few;
  for (uint i = 0u; i < m; ++i) {
    JoinEnd end = light_candidate(group, candidate_of(0u, n, i, u));
    float estimate = end.number + 3u > render.max_depth ? 0.0f : estimate_join(end, here);
    float chance =
        all ? (estimate > 0.0f ? 1.0f : 0.0f) : chance_of(estimate, per_total, alike, 2.0f);
    float after = before + chance;
    bool taken = floor(after) > floor(before);
    before = after;
    if (!taken || s.sides >= kSegmentSides) continue;
    PathVertex light = path_vertices[end.slot];
    Point y = point_of(light);
    if (!sees(y, x_l)) continue;
    Edge e = edge_between(y, x_l);
    Crossing crossing = crossing_of(FROM_LIGHT, y, x_l, drawn_otherwise());
    SegmentSide side;
    side.value = brought_to(x_l, w, y, light, e) * reciprocal(times * chance);
    side.slot = end.slot;
    side.density = crossing.density;
    side.from_light = crossing.from_light;
    side.from_camera = crossing.from_camera;
    side.pad = 0.0f;
    if (is_zero(side.value)) continue;
    segment_sides[segment * kSegmentSides + s.sides] = side;
    s.sides += 1u;
    s.light = s.light + side.value;
  }
}

/// The segment of sample i of a group, and the light that comes to it.
SHARED void draw_segment(uint segment) MEMBER {
  segments[segment].density = 0.0f;
  uint group = segment / render.per_pool;
  uint i = segment % render.per_pool;
  if (i >= samples_of_pool(pool_of_group(group)) || render.max_depth < 2u) return;
  SampleName name = sample_of_group(group, i);
  Sequence numbers = numbers_of(name, PURPOSE_SEGMENT);
  float u0 = uniform_of(numbers);
  float u1 = uniform_of(numbers);
  float u2 = uniform_of(numbers);
  float u3 = uniform_of(numbers);
  float u4 = uniform_of(numbers);
  float u5 = uniform_of(numbers);
  float u6 = uniform_of(numbers);
  float drawn = uniform_of(numbers);
  if (!(drawn < render.segments)) return;
  SegmentDraw draw = sample_segment(u0, u1, u2, u3, u4, u5, u6);
  count_drawn(draw.portal);

  vec3 start = segment_start(draw);
  PortalSegment s;
  s.lit = 0u;
  s.x_l = empty_vertex(segment);
  s.x_c = empty_vertex(segment);
  float presence = 1.0f;
  Point x_l;
  Point x_c;
  if (!end_segment(start, draw.direction, x_c, s.x_c, presence) || !x_c.connectible) return;
  if (!end_segment(start, -draw.direction, x_l, s.x_l, presence)) return;
  if (!x_l.connectible && is_zero(emitted(x_l, draw.direction))) return;
  Edge e = edge_between(x_l, x_c);
  vec3 begin = at_infinity(x_l) ? before_the_scene(x_c.position, x_l.position) : x_l.position;
  if (!(e.d2 > 1e-30f) || !segment_spans(draw.drawn, begin, x_c.position)) return;
  s.x_l.facing = guide_facing(x_l, e.w);
  s.x_c.facing = guide_facing(x_c, -e.w);
  if (guide_active) {
    keep_aims(s.x_l, at_infinity(x_l) ? aim_at_light(x_l) : aim_at_surface(x_l, e.w));
    keep_aims(s.x_c, aim_at_surface(x_c, -e.w));
  }
  Crossing crossing = crossing_of(FROM_LIGHT, x_l, x_c, draw.drawn);
  if (!(crossing.density > 0.0f)) return;
  s.w = e.w;
  s.density = crossing.density;
  s.from_light = crossing.from_light;
  s.from_camera = crossing.from_camera;
  s.pair_A = crossing.density * geometry(x_l, x_c, e);
  s.portal = draw.portal;
  s.sides = 0u;
  s.light = vec3(0.0f, 0.0f, 0.0f);
  s.nee_A = 0.0f;
  if (has_technique(TECHNIQUE_DIRECT)) {
    Outlook outlook;
    if (!at_infinity(x_l)) {
      look_out(x_l, s.x_l.facing, outlook);
      s.x_l.seen = outlook.seen;
      s.x_l.sent = outlook.sent;
    }
    if (x_l.source != SOURCE_NONE) {
      look_out(x_c, s.x_c.facing, outlook);
      s.nee_A = next_event_pdf(x_c, outlook, render.through_windows, x_l.source, x_l.triangle,
                               x_l.position, x_l.in_sky);
    }
  }
  vec3 Le = emitted(x_l, e.w);
  if (!is_zero(Le)) {
    SegmentSide side;
    side.value = Le;
    side.slot = kNoVertex;
    side.density = 0.0f;
    side.from_light = 0.0f;
    side.from_camera = 0.0f;
    side.pad = 0.0f;
    segment_sides[segment * kSegmentSides] = side;
    s.sides = 1u;
    s.light = Le;
  }
  if (!at_infinity(x_l)) {
    seek(numbers, 8u);
    float u = uniform_of(numbers);
    float u_few = uniform_of(numbers);
    join_segment_with_light(segment, group, x_l, e.w, u, u_few, s);
  }
  if (s.sides == 0u) return;
  float through = reciprocal(render.segments * crossing.density * presence);
  s.through = absorbed(vec3(through, through, through), x_l, x_c, e);
  segments[segment] = s;
  JoinEnd end = join_end(x_c, -e.w, s.through, segment, 0u);
  join_ends[segment_ends() + segment] = end;
}

/// Light of prefixes that leave room for t vertices from the camera.
SHARED vec3 light_of(uint segment, uint t) MEMBER_CONST {
  uint n = segments[segment].sides;
  vec3 light = vec3(0.0f, 0.0f, 0.0f);
  for (uint i = 0u; i < n; ++i) {
    SegmentSide side = segment_sides[segment * kSegmentSides + i];
    uint prefix = side.slot == kNoVertex ? 0u : number_of(path_densities[side.slot]) + 1u;
    if (prefix + t + 1u <= render.max_depth) light = light + side.value;
  }
  return light;
}

/// What a path through a segment has on the camera's side.
struct CameraSide {
  Half beyond;       ///< without first_A; no slot where the camera sees x_c
  vec3 to_camera;  ///< unit, from x_c
  float onward_A;  ///< density of x_c in the camera's walk
  float per_area;  ///< |cos| / d^2 at the vertex beyond
  Crossing after;
  float pair_after;
  uint t;
};

/// Adds all paths of a segment and a camera's side, `value` of them but for the light at x_l.
SHARED void add_through(uint segment, CameraSide side, vec3 value, uint pixel,
                        word64 number) MEMBER {
  PortalSegment s = segments[segment];
  Point x_l = point_of(s.x_l);
  Point x_c = point_of(s.x_c);
  Edge e = edge_between(x_l, x_c);
  Aims aims_l = aims_of(s.x_l);
  Aims aims_c = aims_of(s.x_c);
  float per_l = cosine_to(x_l, e.w) * reciprocal(e.d2);
  float per_c = cosine_to(x_c, e.w) * reciprocal(e.d2);
  Crossing middle;
  middle.density = s.density;
  middle.from_light = s.from_light;
  middle.from_camera = s.from_camera;
  float survival = side.t <= 1u ? 1.0f : albedo_at(x_c, side.to_camera);
  float camera_A0 =
      survival * walk_pdf_A(FROM_CAMERA, x_c, aims_c, side.to_camera,
                            scatter_pdf_w(x_c, side.to_camera, -e.w, false), per_l, middle);
  float forward_w = scatter_pdf_w(x_c, -e.w, side.to_camera, false);
  for (uint i = 0u; i < s.sides; ++i) {
    SegmentSide before = segment_sides[segment * kSegmentSides + i];
    bool begins = before.slot == kNoVertex;
    uint a = begins ? 0u : number_of(path_densities[before.slot]) + 1u;
    uint k = a + side.t + 1u;
    if (k > render.max_depth) continue;
    SegmentDensities x;
    x.pair_A = s.pair_A;
    x.camera_A0 = camera_A0;
    x.camera_A1 = side.onward_A;
    x.pair_before = 0.0f;
    x.pair_after = side.pair_after;
    x.nee_A = s.nee_A;
    Half light = no_half();
    vec3 none = vec3(0.0f, 0.0f, 0.0f);
    if (begins) {
      x.light_A0 = light_pdf(x_l.source, x_l.triangle, x_l.position, x_l.in_sky);
      x.light_A1 = onward_pdf_A(FROM_LIGHT, x_l, aims_l, none, e, per_c, middle);
    } else {
      PathVertex v = path_vertices[before.slot];
      PathDensity d = path_densities[before.slot];
      Point y = point_of(v);
      Edge arriving = edge_between(y, x_l);
      Crossing crossing;
      crossing.density = before.density;
      crossing.from_light = before.from_light;
      crossing.from_camera = before.from_camera;
      AtJoint of_y = at_joint(FROM_LIGHT, y, v, d, arriving,
                              cosine_to(x_l, arriving.w) * reciprocal(arriving.d2), crossing, k);
      vec3 back = -arriving.w;
      x.light_A0 = of_y.onward_A;
      float goes_on = a <= 1u ? 1.0f : albedo_at(x_l, back);
      x.light_A1 = goes_on * walk_pdf_A(FROM_LIGHT, x_l, aims_l, back,
                                        scatter_pdf_w(x_l, back, e.w, false), per_c, middle);
      x.pair_before = crossing.density * geometry(y, x_l, arriving);
      light.slot = before.slot;
      light.second_A = of_y.behind_A;
      if (is_met(y)) {
        float per_y = cosine_to(y, arriving.w) * reciprocal(arriving.d2);
        light.first_A =
            albedo_at(x_l, e.w) * walk_pdf_A(FROM_CAMERA, x_l, aims_l, e.w,
                                             scatter_pdf_w(x_l, e.w, back, false), per_y, crossing);
      }
      if (a == 1u && has_technique(TECHNIQUE_DIRECT))
        x.nee_A = next_event_pdf(x_l, outlook_of(s.x_l), render.through_windows, y.source,
                                 y.triangle, y.position, y.in_sky);
    }
    Half camera = side.beyond;
    if (camera.slot != kNoVertex) {
      float goes_on = a == 0u ? 1.0f : albedo_at(x_c, -e.w);
      camera.first_A =
          goes_on * walk_pdf_A(FROM_LIGHT, x_c, aims_c, -e.w, forward_w, side.per_area, side.after);
    }
    float weight = weight_of_segment(light, camera, a, k, x);
    vec3 brought = before.value * value;
    float found = add_found(TECHNIQUE_PORTAL, pixel, k, number, brought, weight);
    if (found > 0.0f) count_lit(s.portal, atomicAdd(segments[segment].lit, 1u) == 0u, found);
  }
}

/// The camera sees x_c.
SHARED void see_segment(uint segment) MEMBER {
  if (!(segments[segment].density > 0.0f)) return;
  PortalSegment s = segments[segment];
  Point x_c = point_of(s.x_c);
  Point camera = empty_point();
  camera.position = render.camera_position;
  Edge e = edge_between(x_c, camera);
  float raster_x;
  float raster_y;
  if (!camera_raster(-e.w, raster_x, raster_y)) return;
  float importance_w = camera_pdf_w(-e.w);
  vec3 value = bsdf_at(x_c, -s.w, e.w) * s.through * (geometry(x_c, camera, e) * importance_w);
  if (is_zero(value) || !seen_by_camera(x_c)) return;
  CameraSide side;
  side.beyond = no_half();
  side.to_camera = e.w;
  side.onward_A = importance_w * cosine_to(x_c, e.w) * reciprocal(e.d2);
  side.per_area = 0.0f;
  side.after = no_crossing();
  side.pair_after = 0.0f;
  side.t = 1u;
  uint group = segment / render.per_pool;
  SampleName name = sample_of_group(group, segment % render.per_pool);
  uint pixel = uint(raster_y) * render.width + uint(raster_x);
  add_through(segment, side, absorbed(value, x_c, camera, e), pixel, name.number);
}

/// z_{t-1} of the camera's walk joined with x_c; `times`: samples that this stands for.
SHARED void join_with_segment(uint segment, uint slot, PathVertex at, PathDensity d, Point z,
                              SampleName name, float times) MEMBER {
  PortalSegment s = segments[segment];
  Point x_c = point_of(s.x_c);
  if (!sees(x_c, z)) return;
  Edge e = edge_between(x_c, z);
  vec3 value = s.through * bsdf_at(x_c, -s.w, e.w) * bsdf_at(z, -e.w, at.back) * at.throughput *
               (geometry(x_c, z, e) * reciprocal(times));
  if (is_zero(value)) return;
  CameraSide side;
  side.after = crossing_of(FROM_LIGHT, x_c, z, drawn_otherwise());
  side.t = number_of(d) + 1u;
  // As many vertices from the light at least.
  AtJoint of_z = at_joint(FROM_CAMERA, z, at, d, reversed(e),
                          cosine_to(x_c, e.w) * reciprocal(e.d2), side.after, 2u);
  side.beyond.slot = slot;
  side.beyond.first_A = 0.0f;
  side.beyond.second_A = of_z.behind_A;
  side.to_camera = e.w;
  side.onward_A = of_z.onward_A;
  side.per_area = cosine_to(z, e.w) * reciprocal(e.d2);
  side.pair_after = side.after.density * geometry(x_c, z, e);
  add_through(segment, side, absorbed(value, x_c, z, e), name.pixel, name.number);
}

SHARED float estimate_segment(uint segment, JoinEnd here, uint t) MEMBER_CONST {
  if (!(segments[segment].density > 0.0f)) return 0.0f;
  return estimate_join(join_ends[segment_ends() + segment], here) * luminance(light_of(segment, t));
}

/// Joins a camera's walk with a few of its pool's segments: of all pairs of one with a vertex those
/// that would bring most.
SHARED void join_few_segments(uint walk) MEMBER {
  uint last = walk_last[walk];
  uint group = walk / render.per_pool;
  if (last == kNoVertex) return;
  uint first = group * render.per_pool;
  uint end = first + samples_of_pool(pool_of_group(group));
  const float kPairs = 3.0f;
  SampleName name = sample_of_group(group, walk % render.per_pool);
  float total = 0.0f;
  uint not_zero = 0u;
  // Twice: what all would bring, and then those that are taken.
  float before = 0.0f;
  float per_total = 0.0f;
  float alike = 0.0f;
  for (uint pass = 0u; pass < 2u; ++pass) {
    for (uint slot = last; slot != kNoVertex; slot = path_densities[slot].prev) {
      PathDensity d = path_densities[slot];
      uint t = number_of(d) + 1u;
      if ((d.flags & VERTEX_CONNECTIBLE) == 0u || t + 1u > render.max_depth) continue;
      PathVertex at = path_vertices[slot];
      Point z = point_of(at);
      JoinEnd here = join_end(z, at.back, at.throughput, slot, t);
      for (uint segment = first; segment < end; ++segment) {
        float estimate = estimate_segment(segment, here, t);
        if (pass == 0u) {
          total += estimate;
          not_zero += estimate > 0.0f ? 1u : 0u;
          continue;
        }
        float chance = float(not_zero) <= kPairs ? (estimate > 0.0f ? 1.0f : 0.0f)
                                                 : chance_of(estimate, per_total, alike, kPairs);
        float after = before + chance;
        if (floor(after) > floor(before))
          join_with_segment(segment, slot, at, d, z, name, float(end - first) * chance);
        before = after;
      }
    }
    if (not_zero == 0u) return;
    per_total = reciprocal(max(total, 1e-37f));
    alike = 0.5f * reciprocal(float(not_zero));
    Sequence numbers = numbers_of(name, PURPOSE_SEGMENT);
    seek(numbers, 12u);
    before = uniform_of(numbers);
  }
}

#include "shaders/shared/language_end.h"
