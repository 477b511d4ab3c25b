// Rays between points of paths: their origins, what they hit, and visibility.
//
// Include after the code on surfaces and lights and after traversal.h, where `render`, camera_culls
// and count_ray() are.

#include "shaders/shared/language.h"

SHARED Point empty_point() MEMBER_CONST {
  vec3 none = vec3(0.0f);
  return simple_point(none, none, kNoTriangle, 0u, none);
}

/// Random number by which one ray decides whether non-opaque surfaces stop it.
SHARED uint ray_coin(vec3 origin, vec3 w) MEMBER_CONST {
  word64 a = word64_of(floatBitsToUint(origin.x), floatBitsToUint(origin.y));
  word64 b = word64_of(floatBitsToUint(origin.z), floatBitsToUint(w.x));
  word64 c = word64_of(floatBitsToUint(w.y), floatBitsToUint(w.z));
  return high_word(mix64(sum64(mix64(sum64(mix64(a), b)), c)));
}

/// Largest absolute coordinate of all triangles: 1 at most, unless the scene reaches far beyond its
/// frame.
SHARED float scene_reach() MEMBER_CONST {
  return load_bvh_node(0u).extent;
}
SHARED float largest_coordinate(vec3 p) MEMBER_CONST {
  return max(max(abs(p.x), abs(p.y)), abs(p.z));
}
/// Offset ray origin: off the surface by a few units in the last place of the coordinates, of the
/// triangle's corners too where the scene reaches far, on the side that the ray leaves from; from a
/// point in the air, along the ray. `triangle`: that it lies on, or kNoTriangle.
SHARED vec3 step_off(vec3 position, vec3 normal, uint triangle, vec3 w) MEMBER_CONST {
  float size = 1.0f;
  if (scene_reach() > 2.0f) {
    size = max(size, largest_coordinate(position));
    if (triangle != kNoTriangle) {
      Face face = load_face(triangle);
      size = max(size, largest_coordinate(face.p0));
      size = max(size, largest_coordinate(face.p0 + face.e1));
      size = max(size, largest_coordinate(face.p0 + face.e2));
    }
  }
  float step = 4.76837158e-7f * size;
  if (is_zero(normal)) return position + w * step;
  return position + normal * (dot(normal, w) < 0.0f ? -step : step);
}

SHARED bool at_infinity(Point p) MEMBER_CONST {
  return p.source != SOURCE_NONE && source_at_infinity(p.source);
}
/// Whether a ray can hit it: true except for lights without surface.
SHARED bool is_met(Point p) MEMBER_CONST {
  return p.source == SOURCE_NONE || source_met(p.source);
}

SHARED Edge edge_between(Point a, Point b) MEMBER_CONST {
  Edge e;
  e.d2 = 1.0f;
  if (at_infinity(a)) {
    e.w = a.position;
  } else if (at_infinity(b)) {
    e.w = -b.position;
  } else {
    vec3 d = b.position - a.position;
    e.d2 = max(dot(d, d), 1e-36f);
    e.w = d * inverse_root(e.d2);
  }
  return e;
}

/// `value` times the transmittance of absorbing solids from a to b; the sky is in no solid.
SHARED vec3 absorbed(vec3 value, Point a, Point b, Edge e) MEMBER_CONST {
  if (!scene_has_absorption || is_zero(value) || at_infinity(a) || at_infinity(b)) return value;
  return value * transmittance(a, b, e.w, root(e.d2));
}

/// Whether two points see each other.
SHARED bool sees(Point a, Point b) MEMBER {
  float before = max(kBeforeTheScene, 2.0f * scene_reach());
  vec3 place_a = at_infinity(a) ? before_the_origin(b.position, a.position, before) : a.position;
  vec3 place_b = at_infinity(b) ? before_the_origin(a.position, b.position, before) : b.position;
  vec3 d = place_b - place_a;
  vec3 w = normalized(d);
  vec3 from = step_off(place_a, a.normal, a.triangle, w);
  vec3 to = step_off(place_b, b.normal, b.triangle, -w);
  count_ray(RAYS_SHADOW);
  return !segment_blocked(from, to, ray_coin(from, to));
}

SHARED bool single_sided(uint triangle) MEMBER_CONST {
  return (load_material(load_face(triangle).material).flags & MATERIAL_DOUBLE_SIDED) == 0u;
}
/// Whether a camera that looks along w draws the side of a triangle that faces it.
SHARED bool camera_draws(uint triangle, vec3 w) MEMBER_CONST {
  return !camera_culls || !single_sided(triangle) || dot(load_face(triangle).normal, w) <= 0.0f;
}
/// First surface along w; for camera rays with culling, the first that is drawn.
SHARED bool first_met(vec3 origin, vec3 w, bool by_film, OUT(SurfaceHit) hit) MEMBER_CONST {
  uint coin = ray_coin(origin, w);
  float passed = 0.0f;
  uint most = camera_culls && by_film ? 256u : 1u;  // back faces in a row
  bool met = false;
  for (uint i = 0u; i < most; ++i) {
    met = first_hit(origin + w * passed, w, coin, hit);
    hit.t += passed;
    if (!met || !by_film || camera_draws(hit.triangle, w)) break;
    met = false;
    passed = hit.t + 4.76837158e-7f;
  }
  return met;
}
/// Whether a camera with culling sees a point of a surface.
SHARED bool seen_by_camera(Point p) MEMBER {
  vec3 camera = render.camera_position;
  vec3 w = normalized(p.position - camera);
  if (!camera_draws(p.triangle, w)) return false;
  count_ray(RAYS_SHADOW);
  vec3 from = step_off(camera, vec3(0.0f, 0.0f, 0.0f), kNoTriangle, w);
  vec3 to = step_off(p.position, p.normal, p.triangle, -w);
  vec3 d = to - from;
  SurfaceHit hit;
  if (!first_met(from, w, true, hit) || hit.triangle == p.triangle) return true;
  return hit.t * hit.t >= dot(d, d);
}

#include "shaders/shared/language_end.h"
