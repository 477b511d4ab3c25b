// Connects ends of sub-paths: chooses pairs of ends, evaluates the BSDFs at both, tests visibility,
// and adds each path's weighted contribution to the film. Each is a step of its own [wavefront.h]
// that runs only for the remaining pairs. Sections 3.1 to 3.3,
// tools/tdpt-render/path/sample/path_sampler.cpp and segment_sampler.cpp.
//
// The light end is a vertex of a light walk, a point on a light, or x_c of a portal segment; the
// camera end is a vertex of a camera walk, the camera itself, or, while a segment is connected with
// light, x_l.
//
// Include after connection_estimates.h, weight.h and film.h, where flags[], connections[] and
// scatterings[] are, and load_x() of the last two, of end_first, connection_end and segment.

#include "shaders/shared/language.h"

// Slots of a segment's ends.
SHARED uint slot_of_x_l(uint segment) MEMBER_CONST {
  return render.segments_first + 2u * segment;
}
SHARED uint slot_of_x_c(uint segment) MEMBER_CONST {
  return render.segments_first + 2u * segment + 1u;
}

SHARED Connection empty_connection(uint kind) MEMBER_CONST {
  Connection j = zero_Connection();
  j.kind = kind;
  j.light = kNoVertex;
  j.camera = kNoVertex;
  j.times = 1.0f;
  j.w = vec3(0.0f, 0.0f, 1.0f);
  j.d2 = 1.0f;
  j.triangle = kNoTriangle;
  return j;
}

// Choosing pairs.

/// A point on a light for the camera vertex in slot `slot`.
SHARED void choose_next_event(uint slot, uint place) MEMBER {
  flags[place] = 0u;
  PathDensity d = load_path_density(slot);
  if ((d.flags & VERTEX_THERE) == 0u || (d.flags & VERTEX_CONNECTIBLE) == 0u) return;
  uint number = number_of(d);
  if (number >= render.max_depth) return;
  PathVertex at = load_path_vertex(slot);
  Point x1 = kept_point(slot, at);
  SampleName name = sample_of_group(at.walk / render.per_cache, at.walk % render.per_cache);
  Sequence numbers = numbers_of(name, PURPOSE_NEXT_EVENT);
  seek(numbers, 4u * number);
  FourNumbers n = four_numbers_of(numbers);
  LightContext light_context = light_context_of(at);
  LightPlace chosen =
      sample_next_event(x1, light_context, render.through_windows, n.c, n.a, n.b, n.d);
  if (chosen.source == SOURCE_NONE || !(chosen.pdf > 0.0f)) return;
  Point x0 = point_on_light(chosen);
  Edge e = edge_between(x0, x1);
  if (!(e.d2 > 1e-30f)) return;
  Connection j = empty_connection(CONNECTION_NEXT_EVENT);
  j.radiance = emitted(x0, e.w);
  if (is_zero(j.radiance)) return;
  j.camera = slot;
  j.w = e.w;
  j.d2 = e.d2;
  j.position = x0.position;
  j.source = x0.source;
  j.normal = x0.normal;
  j.triangle = x0.triangle;
  j.nee_A = chosen.pdf;
  j.light_A = light_pdf(x0.source, x0.triangle, x0.position, chosen.in_sky);
  j.pixel = name.pixel;
  connections[place] = j;
  flags[place] = 1u;
}

/// Candidate i out of n ends, spread evenly from u in [0,1).
SHARED uint candidate_of(uint n, uint i, float u) MEMBER_CONST {
  if (n <= kCandidates) return i;
  return min(uint((float(i) + u) * (float(n) * kPerCandidate)), n - 1u);
}

/// Writes a connection between two ends.
SHARED void put_connection(uint place, uint kind, uint light, vec3 from, bool far, uint camera,
                           vec3 to, float times, uint pixel) MEMBER {
  Connection j = empty_connection(kind);
  j.light = light;
  j.camera = camera;
  j.times = times;
  vec3 d = to - from;
  j.d2 = far ? 1.0f : max(dot(d, d), 1e-36f);
  j.w = far ? from : d * inverse_root(j.d2);
  j.pixel = pixel;
  connections[place] = j;
  flags[place] = 1u;
}

/// Chooses a few of many, one by one [tools/tdpt-render/path/sample/light_vertex_cache.h]: half of
/// the probability is spread equally.
struct Resampling {
  float per_total;
  float equal_share;
  float count;  ///< number to choose; 0: take all
  float before;
};
SHARED Resampling resampling_of(float total, uint not_zero, uint count, float u) MEMBER_CONST {
  Resampling resampling = {reciprocal(max(total, 1e-37f)),
                           0.5f * reciprocal(float(max(not_zero, 1u))),
                           not_zero > count ? float(count) : 0.0f, u};
  return resampling;
}
/// Whether the next one is chosen, and its probability.
SHARED bool takes(INOUT(Resampling) resampling, float estimate, OUT(float) chance) MEMBER_CONST {
  chance = 1.0f;
  if (resampling.count > 0.0f)
    chance = min(
        1.0f, resampling.count * (0.5f * estimate * resampling.per_total + resampling.equal_share));
  float after = resampling.before + (estimate > 0.0f ? chance : 0.0f);
  bool taken = floor(after) > floor(resampling.before);
  resampling.before = after;
  return taken;
}

/// Connects `here` with at most `count` of the n light ends of a cache, chosen by their estimates;
/// they go to the places from `place` on, the rest stays empty. A path has `edges` more edges than
/// the number of the end in its walk. Two numbers in [0,1).
SHARED void choose_ends(uint place, uint count, uint kind, uint group, uint n, ConnectionEnd here,
                        uint camera, uint edges, uint pixel, float u, float u_resampling) MEMBER {
  uint m = min(n, kCandidates);
  float walks = float(walks_of_cache(cache_of_group(group)));
  float times = n <= kCandidates ? walks : walks * float(kCandidates) * reciprocal(float(n));
  float rough[kCandidates];
  float total = 0.0f;
  uint not_zero = 0u;
  count_rays(RAYS_CONNECT, m);
  for (uint k = 0u; k < m; ++k) {
    ConnectionEnd end = load_connection_end(place_of_end(group, candidate_of(n, k, u)));
    float estimate = end.number + edges > render.max_depth ? 0.0f : estimate_connection(end, here);
    rough[k] = estimate;
    total += estimate;
    not_zero += estimate > 0.0f ? 1u : 0u;
  }
  Resampling resampling = resampling_of(total, not_zero, count, u_resampling);
  uint put = 0u;
  for (uint k = 0u; k < m && put < count; ++k) {
    float chance;
    if (!takes(resampling, rough[k], chance)) continue;
    ConnectionEnd end = load_connection_end(place_of_end(group, candidate_of(n, k, u)));
    put_connection(place + put, kind, end.slot, end.position, end.alpha2 < 0.0f, camera,
                   here.position, times * chance, pixel);
    put += 1u;
  }
}

/// Light vertices for the camera vertex in slot `slot`: two places.
SHARED void choose_connections(uint slot, uint place) MEMBER {
  flags[place] = 0u;
  flags[place + 1u] = 0u;
  PathDensity d = load_path_density(slot);
  if ((d.flags & VERTEX_THERE) == 0u || (d.flags & VERTEX_CONNECTIBLE) == 0u) return;
  uint t = number_of(d) + 1u;
  if (t > render.max_depth) return;
  PathVertex at = load_path_vertex(slot);
  uint group = at.walk / render.per_cache;
  SampleName name = sample_of_group(group, at.walk % render.per_cache);
  Sequence numbers = numbers_of(name, PURPOSE_CHOICES);
  seek(numbers, 2u * t);
  float u = uniform_of(numbers);
  float u_resampling = uniform_of(numbers);
  ConnectionEnd here = connection_end(kept_point(slot, at), at.back, at.throughput, slot, t);
  choose_ends(place, connections_of(t), CONNECTION_BI, group,
              first_end(group + 1u) - first_end(group), here, slot, t, name.pixel, u, u_resampling);
}

/// Connects the light vertex in slot `slot`, or x_c of a segment, with the camera.
SHARED void choose_camera(uint place, uint kind, uint light, uint slot, float times) MEMBER {
  PathDensity d = load_path_density(slot);
  if ((d.flags & VERTEX_THERE) == 0u || (d.flags & VERTEX_CONNECTIBLE) == 0u) return;
  vec3 from = load_path_vertex(slot).position;
  vec3 w = normalized(from - render.camera_position);
  float raster_x;
  float raster_y;
  if (!camera_raster(w, raster_x, raster_y)) return;
  uint pixel = uint(raster_y) * render.width + uint(raster_x);
  put_connection(place, kind, light, from, false, kNoVertex, render.camera_position, times, pixel);
}
SHARED void choose_splat(uint slot, uint place) MEMBER {
  flags[place] = 0u;
  uint cache = cache_of_group(load_path_vertex(slot).walk / render.walks_full);
  float times = float(walks_of_cache(cache)) * reciprocal(float(samples_of_cache(cache)));
  choose_camera(place, CONNECTION_SPLAT, slot, slot, times);
}

// BSDFs at both ends.

/// Whether the light end is x_c.
SHARED bool of_segment(Connection j) MEMBER_CONST {
  return j.kind == CONNECTION_SEEN || j.kind == CONNECTION_SEGMENT;
}

/// Evaluates the light end of connection i, or its camera end.
SHARED void scatter_end(uint i, bool of_light) MEMBER {
  Connection j = load_connection(i);
  uint slot = of_light ? j.light : j.camera;
  if (of_light && of_segment(j)) slot = slot_of_x_c(j.light);
  PathVertex at = load_path_vertex(slot);
  if (is_zero(at.back)) return;
  scatterings[2u * i + (of_light ? 0u : 1u)] = scattering_of(
      kept_point(slot, at), at, of_light ? FROM_LIGHT : FROM_CAMERA, of_light ? j.w : -j.w, false);
}

// Connecting.

SHARED OF_FLOAT(Half) no_half() MEMBER_CONST {
  OF_FLOAT(Half) h = {kNoVertex, 0.0f, 0.0f};
  return h;
}

/// Densities at one end of a connection: of the vertex across it in this end's walk, without
/// survival, and of the vertex behind this end in a walk from the other side, likewise.
struct AtJoint {
  float onward_A;
  float behind_A;
};
SHARED AtJoint at_joint(uint from, PathVertex v, PathDensity d, Scattering s, vec3 w,
                        float per_area, CrossingDensity crossing) MEMBER_CONST {
  AtJoint j;
  j.behind_A = 0.0f;
  if (is_zero(v.back)) {
    j.onward_A = emitted_pdf_A(v.source, v.normal, v.guide_total_emitted, w, per_area, crossing);
    return j;
  }
  j.onward_A =
      scattered_pdf_A(from, v, d.own_survival, odds_onward(s), s.onward_w, per_area, crossing);
  uint other_end = from == FROM_LIGHT ? FROM_CAMERA : FROM_LIGHT;
  j.behind_A = scattered_pdf_A(other_end, v, s.survival_behind, odds_behind(s), s.behind_w,
                               v.per_prev, crossing_before(v));
  return j;
}
/// Whether a walk from the other end can hit the vertex before this one.
SHARED bool is_met_behind(PathDensity d) MEMBER_CONST {
  return d.prev != kNoVertex && (load_path_density(d.prev).flags & VERTEX_MET) != 0u;
}

/// Both ends of a connection, with all that a path needs of them.
struct Joint {
  Point y;
  Point z;
  PathVertex light;
  PathVertex camera;
  PathDensity of_light;
  PathDensity of_camera;
  Scattering at_y;
  Scattering at_z;
};

SHARED Joint joint_of(Connection j, uint i) MEMBER_CONST {
  Joint joint;
  joint.light = empty_vertex(0u);
  joint.of_light = empty_density();
  joint.y = empty_point();
  if (j.kind == CONNECTION_NEXT_EVENT) {
    joint.y.position = j.position;
    joint.y.normal = j.normal;
    joint.y.source = j.source;
    joint.y.triangle = j.triangle;
    joint.light.source = j.source;
    joint.light.normal = j.normal;
  } else {
    uint slot = of_segment(j) ? slot_of_x_c(j.light) : j.light;
    joint.light = load_path_vertex(slot);
    joint.of_light = load_path_density(slot);
    joint.y = kept_point(slot, joint.light);
    joint.at_y = load_scattering(2u * i);
  }
  joint.camera = empty_vertex(0u);
  joint.of_camera = empty_density();
  joint.z = empty_point();
  joint.z.position = render.camera_position;
  if (j.camera != kNoVertex) {
    joint.camera = load_path_vertex(j.camera);
    joint.of_camera = load_path_density(j.camera);
    joint.z = kept_point(j.camera, joint.camera);
    joint.at_z = load_scattering(2u * i + 1u);
  }
  return joint;
}

/// Contribution of a connection, without visibility.
SHARED vec3 value_of(Connection j, Joint joint) MEMBER_CONST {
  vec3 sent;
  if (j.kind == CONNECTION_NEXT_EVENT) {
    float per_pdf = reciprocal(j.nee_A);
    sent = j.radiance * per_pdf;
  } else {
    vec3 throughput = of_segment(j) ? load_segment(j.light).through : joint.light.throughput;
    sent = throughput * (is_zero(joint.light.back) ? emitted(joint.y, j.w) : joint.at_y.f);
  }
  vec3 seen;
  if (j.camera == kNoVertex) {
    float importance_w = camera_pdf_w(-j.w);
    seen = vec3(importance_w, importance_w, importance_w);
  } else {
    seen = joint.camera.throughput * joint.at_z.f;
  }
  Edge e = {j.w, j.d2};
  return absorbed(sent * seen * (geometry(joint.y, joint.z, e) * reciprocal(j.times)), joint.y,
                  joint.z, e);
}

/// Whether connection i contributes anything; replaces its radiance by the contribution.
SHARED void see(uint i) MEMBER {
  Connection j = load_connection(i);
  Joint joint = joint_of(j, i);
  vec3 value = value_of(j, joint);
  bool there = !is_zero(value);
  if (there && j.camera == kNoVertex && camera_culls)
    there = seen_by_camera(joint.y);
  else if (there)
    there = sees(joint.y, joint.z);
  flags[i] = there ? 1u : 0u;
  connections[i].radiance = value;
}

/// The edge of a connection, and the densities across it.
struct JoinedEdge {
  bool to_camera;  ///< its camera end is the camera itself
  AtJoint of_y;
  AtJoint of_z;
  float pair_A;     ///< p_AA of the edge
  uint t;           ///< number of vertices from the camera
  float z_goes_on;  ///< survival probability of the camera walk at z; 1 at its first two vertices
};

SHARED JoinedEdge joined_edge(Connection j, Joint joint) MEMBER {
  JoinedEdge e;
  e.to_camera = j.camera == kNoVertex;
  float per_d2 = reciprocal(j.d2);
  float per_y = cosine_to(joint.y, j.w) * per_d2;
  float per_z = cosine_to(joint.z, j.w) * per_d2;
  CrossingDensity crossing = no_crossing();
  if (!e.to_camera) crossing = crossing_of(FROM_LIGHT, joint.y, joint.z, drawn_otherwise());
  e.of_y = at_joint(FROM_LIGHT, joint.light, joint.of_light, joint.at_y, j.w, per_z, crossing);
  e.of_z.onward_A = camera_pdf_w(-j.w) * per_y;
  e.of_z.behind_A = 0.0f;
  if (!e.to_camera)
    e.of_z =
        at_joint(FROM_CAMERA, joint.camera, joint.of_camera, joint.at_z, -j.w, per_y, crossing);
  e.pair_A = crossing.density * cosine_to(joint.y, j.w) * per_z;
  e.t = e.to_camera ? 1u : number_of(joint.of_camera) + 1u;
  e.z_goes_on = e.to_camera ? 1.0f : chance_to_go_on(joint.of_camera);
  return e;
}

/// Adds the path of a next event, of two connected walks, or of a light vertex that the camera
/// sees; i: number of its scatterings.
SHARED void connect(uint i) MEMBER {
  Connection j = load_connection(i);
  Joint joint = joint_of(j, i);
  bool next_event = j.kind == CONNECTION_NEXT_EVENT;
  if (next_event && scene_has_portals && guide_active)
    joint.light.guide_total_emitted = guide_totals_at_light(joint.y).emitted;
  JoinedEdge e = joined_edge(j, joint);
  uint s = next_event ? 1u : number_of(joint.of_light) + 1u;
  uint k = s + e.t - 1u;
  float y_goes_on = next_event ? 1.0f : chance_to_go_on(joint.of_light);
  float camera_A = is_met(joint.y) ? e.z_goes_on * e.of_z.onward_A : 0.0f;
  OF_FLOAT(Half) light = no_half();
  if (!next_event) {
    light.slot = j.light;
    light.first_A = camera_A;
    if (is_met_behind(joint.of_light))
      light.second_A = (e.t <= 1u ? 1.0f : joint.at_y.survival_behind) * e.of_y.behind_A;
  }
  OF_FLOAT(Half) camera = no_half();
  if (!e.to_camera) {
    camera.slot = j.camera;
    camera.first_A = y_goes_on * e.of_y.onward_A;
    if (joint.of_camera.prev != kNoVertex)
      camera.second_A = (s <= 1u ? 1.0f : joint.at_z.survival_behind) * e.of_z.behind_A;
  }
  float weight;
  uint technique = e.to_camera ? TECHNIQUE_LIGHT : TECHNIQUE_BI;
  if (next_event) {
    technique = TECHNIQUE_DIRECT;
    weight = share_of(weight_of_direct(k),
                      strategies_of_next_event(camera, k, j.nee_A, j.light_A, camera_A, e.pair_A));
  } else {
    weight =
        share_of(weight_of_split(s, k), strategies_of_connected(light, camera, s, k, e.pair_A));
  }
  uint walk =
      e.to_camera ? joint.light.walk / render.walks_full : joint.camera.walk / render.per_cache;
  add_found(technique, j.pixel, k, sample_of_group(walk, 0u).number, j.radiance, weight);
}

/// The camera walk has hit a light: x_0 in slot `slot`.
SHARED void meet_light(uint slot) MEMBER {
  PathDensity d = load_path_density(slot);
  if ((d.flags & VERTEX_THERE) == 0u) return;
  PathVertex at = load_path_vertex(slot);
  uint k = number_of(d);
  SampleName name = sample_of_group(at.walk / render.per_cache, at.walk % render.per_cache);
  bool looks_out = k == 1u && (d.flags & VERTEX_INFINITE) != 0u;
  if (film_is_transparent && k == 1u) {
    if (looks_out) return;
    meet_pixel(name.pixel);
  }
  if (!has_technique(TECHNIQUE_CAMERA) || at.source == SOURCE_NONE) return;
  Point x0 = kept_point(slot, at);
  vec3 Le = emitted(x0, at.back);
  if (is_zero(Le)) return;
  float weight = 1.0f;
  if (k > 1u) {
    if (scene_has_sky && at.source == SOURCE_SKY) x0.in_sky = look_at_sky(-at.position);
    OF_FLOAT(Half) camera = no_half();
    camera.slot = slot;
    camera.first_A = light_pdf(x0.source, x0.triangle, x0.position, x0.in_sky);
    camera.second_A = emitted_pdf_A(x0.source, x0.normal, at.guide_total_emitted, at.back,
                                    at.per_prev, crossing_before(at));
    weight =
        share_of(weight_of_split(0u, k), strategies_of_connected(no_half(), camera, 0u, k, 0.0f));
  }
  add_found(TECHNIQUE_CAMERA, name.pixel, k, name.number, at.throughput * Le, weight);
}

#include "shaders/shared/language_end.h"
