// The techniques that end at a vertex of the camera's walk: it meets a light, looks for one, or is
// joined with vertices of light walks; and the light's vertices that the camera sees. Sections 3.1
// to 3.3, tools/tdpt-render/path/path_sampler.cpp. Each adds its weighted share to the film.
//
// Read behind walk.h and weight.h, where join_ends[] and end_first[] are.

#include "shaders/shared/language.h"

const uint kCandidates = 8u;  // of one vertex that it is joined with

/// What a half of a path knows at its joint: densities of what is on the other side in its walk,
/// and of what is behind it in a walk from there.
struct AtJoint {
  float onward_A;
  float behind_A;
};
/// `at`: the vertex next to the joint. `e`: from it; per_area: |cos|/d^2 at the other end.
/// `number`: of it in the walk from the other end, counted from there.
SHARED AtJoint at_joint(uint from, Point at, PathVertex v, PathDensity d, Edge e, float per_area,
                        Crossing crossing, uint number) MEMBER_CONST {
  AtJoint j;
  Aims aims = aims_of(v);
  float survival = number_of(d) <= 1u ? 1.0f : d.own_survival;
  j.onward_A = survival * onward_pdf_A(from, at, aims, v.back, e, per_area, crossing);
  j.behind_A = 0.0f;
  if (d.prev == kNoVertex || (path_densities[d.prev].flags & VERTEX_MET) == 0u) return j;
  Crossing last = crossing;
  last.from_light = v.from_light;
  last.from_camera = v.from_camera;
  float reverse_w = scatter_pdf_w(at, e.w, v.back, false);
  float other = number <= 1u ? 1.0f : albedo_at(at, e.w);
  uint other_end = from == FROM_LIGHT ? FROM_CAMERA : FROM_LIGHT;
  j.behind_A = other * walk_pdf_A(other_end, at, aims, e.w, reverse_w, v.per_prev, last);
  return j;
}

SHARED Half no_half() MEMBER_CONST {
  Half h;
  h.slot = kNoVertex;
  h.first_A = 0.0f;
  h.second_A = 0.0f;
  return h;
}
SHARED vec3 absorbed(vec3 value, Point a, Point b, Edge e) MEMBER_CONST {
  if (!scene_has_absorption) return value;
  return value * transmittance(a, b, e.w, root(e.d2));
}

/// The camera's walk has come upon a light: x_0 in slot `slot`.
SHARED void meet_light(uint slot, PathVertex at, PathDensity d, Point x0, SampleName name) MEMBER {
  vec3 Le = emitted(x0, at.back);
  uint k = number_of(d);
  if (is_zero(Le)) return;
  Half camera = no_half();
  camera.slot = slot;
  float weight = 1.0f;
  if (k > 1u) {
    camera.first_A = light_pdf(x0.source, x0.triangle, x0.position, x0.in_sky);
    Crossing crossing;
    crossing.density = 0.0f;
    crossing.from_light = at.from_light;
    crossing.from_camera = at.from_camera;
    Edge e;
    e.w = at.back;
    e.d2 = 1.0f;
    camera.second_A =
        onward_pdf_A(FROM_LIGHT, x0, aims_of(at), vec3(0.0f, 0.0f, 0.0f), e, at.per_prev, crossing);
    weight = weight_of_joined(no_half(), camera, 0u, k, 0.0f);
  }
  add_found(TECHNIQUE_CAMERA, name.pixel, k, name.number, at.throughput * Le, weight);
}

/// A place on a light for vertex x_1 of the camera's walk.
SHARED void look_for_light(uint slot, PathVertex at, PathDensity d, Point x1,
                           SampleName name) MEMBER {
  uint j = number_of(d);
  Sequence numbers = numbers_of(name, PURPOSE_NEXT_EVENT);
  seek(numbers, 4u * j);
  float u = uniform_of(numbers);
  float v = uniform_of(numbers);
  float pick = uniform_of(numbers);
  float side = uniform_of(numbers);
  Outlook outlook = outlook_of(at);
  LightPlace place = sample_next_event(x1, outlook, render.through_windows, pick, u, v, side);
  if (place.source == SOURCE_NONE || !(place.pdf > 0.0f)) return;
  Point x0 = point_on_light(place.source, place.triangle, place.b1, place.b2, place.position,
                            place.in_sky);
  Edge e = edge_between(x1, x0);
  if (!(e.d2 > 1e-30f)) return;
  vec3 Le = emitted(x0, -e.w);
  vec3 value = at.throughput * bsdf_at(x1, e.w, at.back) * Le *
               (geometry(x1, x0, e) * reciprocal(place.pdf));
  if (is_zero(value) || !sees(x1, x0)) return;
  value = absorbed(value, x1, x0, e);
  uint k = j + 1u;
  Crossing crossing = crossing_of(FROM_LIGHT, x0, x1, drawn_otherwise());
  AtJoint camera_side =
      at_joint(FROM_CAMERA, x1, at, d, e, cosine_to(x0, e.w) * reciprocal(e.d2), crossing, 1u);
  Aims aims;
  aims.facing = source_facing(x0.source, x0.normal);
  aims.from_light = 0.0f;
  aims.from_camera = 0.0f;
  aims.emitted = 0.0f;
  if (scene_has_portals && guide_active) aims = aim_at_light(x0);
  Half camera = no_half();
  camera.slot = slot;
  camera.first_A = onward_pdf_A(FROM_LIGHT, x0, aims, vec3(0.0f, 0.0f, 0.0f), reversed(e),
                                cosine_to(x1, e.w) * reciprocal(e.d2), crossing);
  camera.second_A = camera_side.behind_A;
  float light_A = light_pdf(x0.source, x0.triangle, x0.position, x0.in_sky);
  float camera_A = is_met(x0) ? camera_side.onward_A : 0.0f;
  float pair_A = crossing.density * geometry(x0, x1, e);
  float weight = weight_of_next_event(camera, k, place.pdf, light_A, camera_A, pair_A);
  add_found(TECHNIQUE_DIRECT, name.pixel, k, name.number, value, weight);
}

/// Joins vertex z_{t-1} of the camera's walk with y_{s-1}; `times`: samples that this stands for.
SHARED void join_with(JoinEnd end, uint slot, PathVertex at, PathDensity d, Point z,
                      SampleName name, float times) MEMBER {
  PathVertex light = path_vertices[end.slot];
  PathDensity of_light = path_densities[end.slot];
  Point y = point_of(light);
  if (!sees(y, z)) return;
  Edge e = edge_between(y, z);
  Edge r = reversed(e);
  vec3 value = light.throughput * bsdf_at(y, light.back, e.w) * bsdf_at(z, r.w, at.back) *
               at.throughput * (geometry(y, z, e) * reciprocal(times));
  if (is_zero(value)) return;
  value = absorbed(value, y, z, e);
  uint s = number_of(of_light) + 1u;
  uint t = number_of(d) + 1u;
  uint k = s + t - 1u;
  Crossing crossing = crossing_of(FROM_LIGHT, y, z, drawn_otherwise());
  float per_z = cosine_to(z, e.w) * reciprocal(e.d2);
  float per_y = cosine_to(y, e.w) * reciprocal(e.d2);
  AtJoint of_y = at_joint(FROM_LIGHT, y, light, of_light, e, per_z, crossing, t);
  AtJoint of_z = at_joint(FROM_CAMERA, z, at, d, r, per_y, crossing, s);
  Half light_half;
  light_half.slot = end.slot;
  light_half.first_A = of_z.onward_A;
  light_half.second_A = of_y.behind_A;
  Half camera_half;
  camera_half.slot = slot;
  camera_half.first_A = of_y.onward_A;
  camera_half.second_A = of_z.behind_A;
  float pair_A = crossing.density * geometry(y, z, e);
  float weight = weight_of_joined(light_half, camera_half, s, k, pair_A);
  add_found(TECHNIQUE_BI, name.pixel, k, name.number, value, weight);
}

// join_ends[] has those of y_0 of all walks, then those of segments on the camera's side, by their
// numbers, then those of all other vertices of light walks, pool by pool.
SHARED uint segment_ends() MEMBER_CONST {
  return render.groups * render.walks_full;
}
SHARED uint scattered_ends() MEMBER_CONST {
  return render.groups * (render.walks_full + render.per_pool);
}
/// The first of a pool, among the last.
SHARED uint first_end(uint group) MEMBER_CONST {
  return end_first[group * render.walks_full];
}

/// Candidate i of those that join_ends[] has of a pool, spread evenly from u in [0,1).
SHARED uint candidate_of(uint first, uint n, uint i, float u) MEMBER_CONST {
  if (n <= kCandidates) return first + i;
  float step = float(n) * 0.125f;
  return first + min(uint((float(i) + u) * step), n - 1u);
}

/// Chance of a term among `n` that are not 0, `count` of which are wanted [few.h].
SHARED float chance_of(float estimate, float per_total, float alike, float count) MEMBER_CONST {
  if (estimate == 0.0f) return 0.0f;
  return min(1.0f, count * (0.5f * estimate * per_total + alike));
}

/// Joins z_{t-1} with a few of its pool's light vertices.
SHARED void join_few(uint slot, PathVertex at, PathDensity d, Point z, uint group,
                     SampleName name) MEMBER {
  uint first = first_end(group);
  uint n = first_end(group + 1u) - first;
  if (n == 0u) return;
  uint t = number_of(d) + 1u;
  uint count = t <= 3u ? 2u : 1u;
  Sequence numbers = numbers_of(name, PURPOSE_CHOICES);
  seek(numbers, 2u * t);
  float u = uniform_of(numbers);
  float u_few = uniform_of(numbers);
  uint m = min(n, kCandidates);
  float walks = float(walks_of_pool(pool_of_group(group)));
  float times = n <= kCandidates ? walks : walks * 8.0f * reciprocal(float(n));
  JoinEnd here = join_end(z, at.back, at.throughput, slot, number_of(d));
  float total = 0.0f;
  uint not_zero = 0u;
  for (uint i = 0u; i < m; ++i) {
    count_ray(RAYS_JOIN);
    JoinEnd end = join_ends[scattered_ends() + candidate_of(first, n, i, u)];
    float estimate = end.number + t > render.max_depth ? 0.0f : estimate_join(end, here);
    total += estimate;
    not_zero += estimate > 0.0f ? 1u : 0u;
  }
  if (not_zero == 0u) return;
  bool all = not_zero <= count;
  float per_total = reciprocal(max(total, 1e-37f));
  float alike = 0.5f * reciprocal(float(not_zero));
  float before = u_few;
  for (uint i = 0u; i < m; ++i) {
    JoinEnd end = join_ends[scattered_ends() + candidate_of(first, n, i, u)];
    float estimate = end.number + t > render.max_depth ? 0.0f : estimate_join(end, here);
    float chance =
        all ? (estimate > 0.0f ? 1.0f : 0.0f) : chance_of(estimate, per_total, alike, float(count));
    float after = before + chance;
    if (floor(after) > floor(before)) join_with(end, slot, at, d, z, name, times * chance);
    before = after;
  }
}

/// All that ends at the camera's vertex in slot `slot`, and has no segment.
SHARED void connect_camera_vertex(uint slot) MEMBER {
  PathDensity d = path_densities[slot];
  if ((d.flags & VERTEX_THERE) == 0u) return;
  PathVertex at = path_vertices[slot];
  uint group = at.walk / render.per_pool;
  SampleName name = sample_of_group(group, at.walk % render.per_pool);
  Point z = point_of(at);
  bool looks_out = number_of(d) == 1u && (d.flags & VERTEX_INFINITE) != 0u;
  if (render.transparent != 0u && number_of(d) == 1u && !looks_out) meet_pixel(name.pixel);
  if (has_technique(TECHNIQUE_CAMERA) && z.source != SOURCE_NONE &&
      !(render.transparent != 0u && looks_out))
    meet_light(slot, at, d, z, name);
  if (!z.connectible || number_of(d) >= render.max_depth) return;
  if (has_technique(TECHNIQUE_DIRECT)) look_for_light(slot, at, d, z, name);
  if (has_technique(TECHNIQUE_BI)) join_few(slot, at, d, z, group, name);
}

/// Vertex y_i, i >= 1, of a light's walk as the camera sees it.
SHARED void splat(uint slot) MEMBER {
  PathDensity d = path_densities[slot];
  if ((d.flags & VERTEX_THERE) == 0u || (d.flags & VERTEX_CONNECTIBLE) == 0u || number_of(d) == 0u)
    return;
  PathVertex at = path_vertices[slot];
  Point camera = empty_point();
  camera.position = render.camera_position;
  Point y = point_of(at);
  Edge e = edge_between(y, camera);
  float raster_x;
  float raster_y;
  if (!camera_raster(-e.w, raster_x, raster_y)) return;
  float importance_w = camera_pdf_w(-e.w);
  uint group = at.walk / render.walks_full;
  uint pool = pool_of_group(group);
  float times = float(walks_of_pool(pool)) * reciprocal(float(samples_of_pool(pool)));
  vec3 value = at.throughput * bsdf_at(y, at.back, e.w) *
               (geometry(y, camera, e) * importance_w * reciprocal(times));
  if (is_zero(value) || !seen_by_camera(y)) return;
  value = absorbed(value, y, camera, e);
  uint k = number_of(d) + 1u;
  Half light = no_half();
  light.slot = slot;
  light.first_A = importance_w * cosine_to(y, e.w) * reciprocal(e.d2);
  light.second_A = at_joint(FROM_LIGHT, y, at, d, e, 0.0f, no_crossing(), 1u).behind_A;
  float weight = weight_of_joined(light, no_half(), k, k, 0.0f);
  uint pixel = uint(raster_y) * render.width + uint(raster_x);
  add_found(TECHNIQUE_LIGHT, pixel, k, sample_of_group(group, 0u).number, value, weight);
}

#include "shaders/shared/language_end.h"
