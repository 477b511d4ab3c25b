// Portal segments: drawn, connected with the light's side, then with the camera's. Sections 3.1.1
// and 3.2, tools/tdpt-render/path/sample/segment_sampler.cpp. x_l and x_c are the ends on the
// light's and on the camera's side. The segment of a sample has the sample's number within the
// submission.
//
// Include after connect.h; walk_last, rank, estimate, segment_side, lit_segment and lit_first are
// loaded, and segments[], segment_sides[], connection_ends[], lit_segments[], lit_first[] and
// estimates[] are written.

#include "shaders/shared/language.h"

/// The two rays of a sample's segment, to x_l and then to x_c, as rays of walks.
SHARED void begin_segment(uint segment) MEMBER {
  segments[segment].density = 0.0f;
  segments[segment].there = 0u;
  segments[segment].lit = 0u;
  walk_rays[2u * segment] = no_ray(segment);
  walk_rays[2u * segment + 1u] = no_ray(segment);
  uint group = segment / render.per_cache;
  uint i = segment % render.per_cache;
  if (i >= samples_of_cache(cache_of_group(group)) || render.max_depth < 2u) return;
  Sequence numbers = numbers_of(sample_of_group(group, i), PURPOSE_SEGMENT);
  FourNumbers u = four_numbers_of(numbers);
  FourNumbers more = four_numbers_of(numbers);
  if (!(more.d < render.segments)) return;
  SegmentDraw draw = sample_segment(u.a, u.b, u.c, u.d, more.a, more.b, more.c);
  count_drawn(draw.portal);
  segments[segment].portal = draw.portal;
  WalkRay ray = no_ray(segment);
  ray.origin = segment_start(draw);
  ray.flags = RAY_THERE;
  ray.w = -draw.direction;
  ray.polygon = draw.drawn.polygon;
  walk_rays[2u * segment] = ray;
  ray.w = draw.direction;
  ray.polygon = draw.drawn.second;
  walk_rays[2u * segment + 1u] = ray;
}

SHARED SegmentSide empty_side(vec3 value, uint slot) MEMBER_CONST {
  SegmentSide side = zero_SegmentSide();
  side.value = value;
  side.slot = slot;
  return side;
}

/// Stores end `i` & 1 of segment i / 2 in its slot.
SHARED void end_segment(uint i) MEMBER {
  uint slot = render.segments_first + i;
  path_densities[slot].flags = 0u;
  WalkRay ray = load_walk_ray(i);
  bool met = ray.triangle != kNoTriangle;
  if ((ray.flags & RAY_THERE) == 0u || (!met && !scene_has_sky)) return;
  Point p = point_reached(ray);
  PathVertex v = vertex_reached(slot, ray, p, -ray.w, has_technique(TECHNIQUE_DIRECT) && met);
  // Only the coverage of a pane: put_segment_together() moves it into the segment.
  if (met && scene_has_panes)
    v.throughput = v.throughput * reciprocal(opacity_at(ray.triangle, ray.w));
  path_vertices[slot] = v;
  PathDensity d = empty_density();
  uint from = (i & 1u) == 0u ? FROM_CAMERA : FROM_LIGHT;  // of walks that arrive from the other end
  d.own_survival = survival_where(from, v, albedo_at(p, v.back));
  // Any walk that arrives here has at least two vertices; other cases are treated separately.
  d.flags = flags_of(p, 2u);
  path_densities[slot] = d;
}

/// Light that begins at x_l and goes along w to x_c; `per_area` converts its density to area there;
/// l, c: the vertices of both.
SHARED SegmentSide side_of_source(vec3 Le, Point x_l, PathVertex l, Point x_c, PathVertex c, vec3 w,
                                  float per_area, CrossingDensity crossing) MEMBER_CONST {
  if (scene_has_sky && x_l.source == SOURCE_SKY) x_l.in_sky = look_at_sky(-x_l.position);
  SegmentSide side = empty_side(Le, kNoVertex);
  side.light_A0 = light_pdf(x_l.source, x_l.triangle, x_l.position, x_l.in_sky);
  side.light_A1 =
      emitted_pdf_A(x_l.source, x_l.normal, l.guide_total_emitted, w, per_area, crossing);
  if (has_technique(TECHNIQUE_DIRECT))
    side.nee_A = next_event_pdf(x_c, light_context_of(c), render.through_windows, x_l.source,
                                x_l.triangle, x_l.position, x_l.in_sky);
  return side;
}

/// Combines both ends, and adds light that begins at x_l.
SHARED void put_segment_together(uint segment) MEMBER {
  uint slot = slot_of_x_l(segment);
  uint flags_l = load_path_density(slot).flags;
  uint flags_c = load_path_density(slot + 1u).flags;
  if ((flags_l & flags_c & VERTEX_THERE) == 0u || (flags_c & VERTEX_CONNECTIBLE) == 0u) return;
  PathVertex l = load_path_vertex(slot);
  PathVertex c = load_path_vertex(slot + 1u);
  Point x_l = kept_point(slot, l);
  Point x_c = kept_point(slot + 1u, c);
  Edge e = edge_between(x_l, x_c);
  vec3 Le = emitted(x_l, e.w);
  if (!x_l.connectible && is_zero(Le)) return;
  Drawn drawn =
      drawn_through(load_walk_ray(2u * segment).polygon, load_walk_ray(2u * segment + 1u).polygon);
  vec3 begin = at_infinity(x_l) ? before_the_scene(x_c.position, x_l.position) : x_l.position;
  if (!(e.d2 > 1e-30f) || !segment_spans(drawn, begin, x_c.position)) return;
  CrossingDensity crossing = crossing_of(FROM_LIGHT, x_l, x_c, drawn);
  if (!(crossing.density > 0.0f)) return;
  float per_d2 = reciprocal(e.d2);
  path_vertices[slot].per_prev = cosine_to(x_c, e.w) * per_d2;
  path_vertices[slot].from_light = crossing.from_light;
  path_vertices[slot].from_camera = crossing.from_camera;
  path_vertices[slot + 1u].per_prev = cosine_to(x_l, e.w) * per_d2;
  path_vertices[slot + 1u].from_light = crossing.from_light;
  path_vertices[slot + 1u].from_camera = crossing.from_camera;
  path_vertices[slot].throughput = vec3(1.0f, 1.0f, 1.0f);
  PortalSegment s = load_segment(segment);
  s.density = crossing.density;
  s.pair_A = crossing.density * geometry(x_l, x_c, e);
  s.through = absorbed(l.throughput * c.throughput * reciprocal(render.segments * crossing.density),
                       x_l, x_c, e);
  connection_ends[segment_ends() + segment] = connection_end(x_c, -e.w, s.through, segment, 0u);
  if (!is_zero(Le)) {
    segment_sides[segment * kSegmentSides] =
        side_of_source(Le, x_l, l, x_c, c, e.w, cosine_to(x_c, e.w) * per_d2, crossing);
    s.there = 1u;
  }
  segments[segment] = s;
}

/// Light vertices for x_l: two places.
SHARED void choose_sides(uint segment, uint place) MEMBER {
  flags[place] = 0u;
  flags[place + 1u] = 0u;
  if (!(load_segment(segment).density > 0.0f)) return;
  uint slot = slot_of_x_l(segment);
  PathVertex l = load_path_vertex(slot);
  Point x_l = kept_point(slot, l);
  if (at_infinity(x_l)) return;
  uint group = segment / render.per_cache;
  Sequence numbers =
      numbers_of(sample_of_group(group, segment % render.per_cache), PURPOSE_SEGMENT);
  seek(numbers, 8u);
  float u = uniform_of(numbers);
  float u_resampling = uniform_of(numbers);
  uint n = first_end(group + 1u) - first_end(group) + walks_of_cache(cache_of_group(group));
  ConnectionEnd here = connection_end(x_l, l.back, vec3(1.0f, 1.0f, 1.0f), slot, 0u);
  choose_ends(place, 2u, CONNECTION_SIDE, group, n, here, slot, 3u, segment, u, u_resampling);
}

/// Connects x_l with a chosen vertex: side 1 or 2 of the segment. i: number of the scatterings.
SHARED void connect_side(uint i) MEMBER {
  Connection j = load_connection(i);
  uint segment = j.pixel;
  uint place = segment * kSegmentSides + 1u + (i & 1u);
  Joint joint = joint_of(j, i);
  JoinedEdge e = joined_edge(j, joint);
  uint a = number_of(joint.of_light) + 1u;
  SegmentSide side = empty_side(j.radiance, j.light);
  side.light_A0 = chance_to_go_on(joint.of_light) * e.of_y.onward_A;
  side.light_A1 = (a <= 1u ? 1.0f : joint.at_z.survival_behind) * e.of_z.behind_A;
  side.first_A = is_met(joint.y) ? e.z_goes_on * e.of_z.onward_A : 0.0f;
  if (is_met_behind(joint.of_light)) side.second_A = joint.at_y.survival_behind * e.of_y.behind_A;
  side.pair_before = e.pair_A;
  if (a == 1u && has_technique(TECHNIQUE_DIRECT)) {
    if (scene_has_sky && joint.y.source == SOURCE_SKY)
      joint.y.in_sky = look_at_sky(-joint.y.position);
    side.nee_A = next_event_pdf(joint.z, light_context_of(joint.camera), render.through_windows,
                                joint.y.source, joint.y.triangle, joint.y.position, joint.y.in_sky);
  }
  segment_sides[place] = side;
}

SHARED uint prefix_of(SegmentSide side) MEMBER_CONST {
  return side.slot == kNoVertex ? 0u : number_of(load_path_density(side.slot)) + 1u;
}
const uint kMostPrefix = 1023u;  // longest prefix that estimates distinguish

/// Records which sides exist, and their light for estimates.
SHARED void gather_sides(uint segment, uint place) MEMBER {
  PortalSegment s = load_segment(segment);
  if (!(s.density > 0.0f)) return;
  s.there |= flags[place] << 1u | flags[place + 1u] << 2u;
  if (s.there == 0u) s.density = 0.0f;
  segments[segment] = s;
  uint prefixes = 0u;
  float light[kSegmentSides];
  for (uint i = 0u; i < kSegmentSides; ++i) {
    SegmentSide side = load_segment_side(segment * kSegmentSides + i);
    bool there = (s.there >> i & 1u) != 0u;
    light[i] = there ? luminance(side.value) : 0.0f;
    if (there) prefixes |= min(prefix_of(side), kMostPrefix) << (10u * i);
  }
  uint end = segment_ends() + segment;
  connection_ends[end].number = prefixes;
  connection_ends[end].light0 = light[0];
  connection_ends[end].light1 = light[1];
  connection_ends[end].light2 = light[2];
}

/// Luminance of prefixes short enough to leave room for t camera vertices.
SHARED float light_of(ConnectionEnd far, uint t) MEMBER_CONST {
  uint most = render.max_depth - min(render.max_depth, t + 1u);
  float light = (far.number & kMostPrefix) <= most ? far.light0 : 0.0f;
  light += (far.number >> 10u & kMostPrefix) <= most ? far.light1 : 0.0f;
  light += far.number >> 20u <= most ? far.light2 : 0.0f;
  return light;
}

/// Connects a segment with the camera: one place.
SHARED void choose_seen(uint segment, uint place) MEMBER {
  flags[place] = 0u;
  if (load_segment(segment).density > 0.0f)
    choose_camera(place, CONNECTION_SEEN, segment, slot_of_x_c(segment), 1.0f);
}
SHARED void flag_lit(uint segment, uint place) MEMBER {
  flags[place] = load_segment(segment).density > 0.0f ? 1u : 0u;
}
/// Lists the flagged segments, and for each cache its first one.
SHARED void list_lit(uint segment) MEMBER {
  uint rank = load_rank(segment);
  if (flags[segment] != 0u) lit_segments[rank] = segment;
  if (segment % render.per_cache == 0u) lit_first[segment / render.per_cache] = rank;
  if (segment + 1u == work.count) lit_first[render.groups] = rank + flags[segment];
}

// Row of a camera vertex: the sum of its estimates, how many are not zero, and the estimates, one
// for each lit segment of its cache.
SHARED uint row_of_estimates(uint i) MEMBER_CONST {
  return i * (render.per_cache + 2u);
}

/// Estimates of the segments of its cache for the camera vertex in slot `slot`, into row i.
SHARED void estimate_segments(uint slot, uint i) MEMBER {
  uint row = row_of_estimates(i);
  estimates[row] = 0.0f;
  estimates[row + 1u] = 0.0f;
  PathDensity d = load_path_density(slot);
  uint t = number_of(d) + 1u;
  if ((d.flags & VERTEX_THERE) == 0u || (d.flags & VERTEX_CONNECTIBLE) == 0u) return;
  if (t + 1u > render.max_depth) return;
  PathVertex at = load_path_vertex(slot);
  uint group = at.walk / render.per_cache;
  uint first = load_lit_first(group);
  uint n = load_lit_first(group + 1u) - first;
  ConnectionEnd here = connection_end(kept_point(slot, at), at.back, at.throughput, slot, t);
  float total = 0.0f;
  uint not_zero = 0u;
  for (uint k = 0u; k < n; ++k) {
    ConnectionEnd far = load_connection_end(segment_ends() + load_lit_segment(first + k));
    float estimate = estimate_connection(far, here) * light_of(far, t);
    estimates[row + 2u + k] = estimate;
    total += estimate;
    not_zero += estimate > 0.0f ? 1u : 0u;
  }
  count_rays(RAYS_CONNECT, n);
  estimates[row] = total;
  estimates[row + 1u] = float(not_zero);
}

/// Chooses, of all pairs of a vertex of a camera walk and a segment of its cache, a few by their
/// estimates: three places. `first_slot`: of the first row of estimates.
SHARED void choose_segments(uint walk, uint place, uint first_slot) MEMBER {
  for (uint i = 0u; i < kPairs; ++i) flags[place + i] = 0u;
  uint last = load_walk_last(walk);
  float total = 0.0f;
  uint not_zero = 0u;
  for (uint slot = last; slot != kNoVertex; slot = load_path_density(slot).prev) {
    uint row = row_of_estimates(slot - first_slot);
    total += load_estimate(row);
    not_zero += uint(load_estimate(row + 1u));
  }
  if (not_zero == 0u) return;
  uint group = walk / render.per_cache;
  uint first = load_lit_first(group);
  uint n = load_lit_first(group + 1u) - first;
  float segments_there = float(samples_of_cache(cache_of_group(group)));
  SampleName name = sample_of_group(group, walk % render.per_cache);
  Sequence numbers = numbers_of(name, PURPOSE_SEGMENT);
  seek(numbers, 12u);
  Resampling resampling = resampling_of(total, not_zero, kPairs, uniform_of(numbers));
  uint put = 0u;
  for (uint slot = last; slot != kNoVertex; slot = load_path_density(slot).prev) {
    uint row = row_of_estimates(slot - first_slot);
    uint of_row = load_estimate(row + 1u) > 0.0f ? n : 0u;
    for (uint k = 0u; k < of_row && put < kPairs; ++k) {
      float chance;
      if (!takes(resampling, load_estimate(row + 2u + k), chance)) continue;
      uint segment = load_lit_segment(first + k);
      put_connection(place + put, CONNECTION_SEGMENT, segment,
                     load_connection_end(segment_ends() + segment).position, false, slot,
                     load_path_vertex(slot).position, segments_there * chance, name.pixel);
      put += 1u;
    }
  }
}

/// Adds all paths of a segment to a chosen camera vertex, or to the camera itself.
SHARED void connect_segment(uint i) MEMBER {
  Connection j = load_connection(i);
  Joint joint = joint_of(j, i);
  PortalSegment s = load_segment(j.light);
  JoinedEdge e = joined_edge(j, joint);
  OF_FLOAT(Half) camera = no_half();
  OF_FLOAT(SegmentDensities) x;
  x.pair_A = s.pair_A;
  x.camera_A0 = (e.to_camera ? 1.0f : joint.at_y.survival_behind) * e.of_y.behind_A;
  x.camera_A1 = e.z_goes_on * e.of_z.onward_A;
  x.pair_after = e.pair_A;
  if (!e.to_camera) {
    camera.slot = j.camera;
    if (joint.of_camera.prev != kNoVertex)
      camera.second_A = joint.at_z.survival_behind * e.of_z.behind_A;
  }
  uint group = e.to_camera ? j.light / render.per_cache : joint.camera.walk / render.per_cache;
  word64 number = sample_of_group(group, 0u).number;
  for (uint side_number = 0u; side_number < kSegmentSides; ++side_number) {
    if ((s.there >> side_number & 1u) == 0u) continue;
    SegmentSide side = load_segment_side(j.light * kSegmentSides + side_number);
    uint a = prefix_of(side);
    uint k = a + e.t + 1u;
    if (k > render.max_depth) continue;
    x.light_A0 = side.light_A0;
    x.light_A1 = side.light_A1;
    x.pair_before = side.pair_before;
    x.nee_A = side.nee_A;
    OF_FLOAT(Half) light = no_half();
    light.slot = side.slot;
    light.first_A = side.first_A;
    light.second_A = side.second_A;
    if (!e.to_camera)
      camera.first_A = (a == 0u ? 1.0f : joint.of_light.own_survival) * e.of_y.onward_A;
    float weight = share_of(weight_of_portal(a, k), strategies_of_segment(light, camera, a, k, x));
    float found = add_found(TECHNIQUE_PORTAL, j.pixel, k, number, side.value * j.radiance, weight);
    if (found > 0.0f) count_lit(s.portal, atomicAdd(segments[j.light].lit, 1u) == 0u, found);
  }
}

#include "shaders/shared/language_end.h"
