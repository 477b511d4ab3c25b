// Estimates the contribution of two ends of walks, without visibility, to choose which pairs get a
// ray. The same as tools/tdpt-render/path/sample/connect.cpp.
//
// Between diffuse ends only rounding differs from the exact value; for glossy ends masking and the
// Fresnel curve are approximate. Half of the probability is spread equally, so that nothing is lost
// where an estimate is too small, and a chosen pair is divided by its probability.
//
// Include after walk.h, where connection_ends[] and load_end_first() are.

#include "shaders/shared/language.h"

// Order of connection_ends[]: y_0 of all walks, then the ends x_c of segments by their numbers,
// then all other light vertices, cache by cache.
SHARED uint segment_ends() MEMBER_CONST {
  return render.groups * render.walks_full;
}
SHARED uint scattered_ends() MEMBER_CONST {
  return render.groups * (render.walks_full + render.per_cache);
}
/// Index, within the last part, of a cache's first end.
SHARED uint first_end(uint group) MEMBER_CONST {
  return load_end_first(group * render.walks_full);
}
/// Index of a cache's end c: first its scattered vertices, then its y_0.
SHARED uint place_of_end(uint group, uint c) MEMBER_CONST {
  uint first = first_end(group);
  uint n = first_end(group + 1u) - first;
  return c < n ? scattered_ends() + first + c : group * render.walks_full + c - n;
}

/// The end of a walk with this throughput that arrived along -back.
SHARED ConnectionEnd connection_end(Point p, vec3 back, vec3 throughput, uint slot,
                                    uint number) MEMBER_CONST {
  ConnectionEnd e = zero_ConnectionEnd();
  e.position = p.position;
  e.slot = slot;
  e.number = number;
  bool transmits = !p.simple && largest(p.bsdf.through) > 0.0f;
  bool begins = is_zero(back);
  vec3 side = dot(p.normal, back) > 0.0f ? p.normal : -p.normal;
  e.facing = begins || transmits ? vec3(0.0f, 0.0f, 0.0f) : side;
  e.back = back;
  e.normal = side;
  e.cosine = 1.0f;
  if (p.simple || begins) {
    e.carried = throughput * (begins ? vec3(1.0f, 1.0f, 1.0f) : p.color) * INVERSE_PI;
    return e;
  }
  float c = dot(p.shading, back);
  e.normal = c < 0.0f ? -p.shading : p.shading;
  e.cosine = max(abs(c), 1e-3f);
  e.alpha2 = max(p.bsdf.alpha * p.bsdf.alpha, 1e-6f);
  e.f0 = throughput * p.bsdf.f0;
  e.more = throughput * (vec3(p.bsdf.f90) - p.bsdf.f0);
  vec3 left = vec3(max(1.0f - p.bsdf.f0.x, 0.05f), max(1.0f - p.bsdf.f0.y, 0.05f),
                   max(1.0f - p.bsdf.f0.z, 0.05f));
  float coat = 0.1f * p.bsdf.coat.strength;
  vec3 above = p.bsdf.sheen * 0.3f + vec3(coat, coat, coat);
  e.carried = throughput * (p.bsdf.diffuse * left + above) * INVERSE_PI;
  return e;
}

/// Scattering of an end along unit w: its diffuse lobe and that of the interface.
SHARED vec3 roughly_scattered(ConnectionEnd e, vec3 w) MEMBER_CONST {
  if (!(e.alpha2 > 0.0f)) return e.carried;
  vec3 h = e.back + w;
  float scale = inverse_root(dot(h, h) + 1e-12f);
  float cos_h = dot(e.normal, h) * scale;
  float cos_d = dot(e.back, h) * scale;
  float cos_w = max(dot(e.normal, w), 1e-3f);
  float a2 = e.alpha2;
  float s = max(cos_h * cos_h * (a2 - 1.0f) + 1.0f, a2);
  float d = a2 * reciprocal(s * s);
  float v = reciprocal(cos_w * root(a2 + (1.0f - a2) * e.cosine * e.cosine) +
                       e.cosine * root(a2 + (1.0f - a2) * cos_w * cos_w));
  float lobe = d * v * 0.159154943f;
  float m = max(1.0f - cos_d, 0.0f);
  float m2 = m * m;
  return e.carried + (e.f0 + e.more * (m2 * m2 * m)) * lobe;
}

/// Luminance of the light from `l` to `c`, at most 1e30; 0 if there is none.
SHARED float estimate_connection(ConnectionEnd l, ConnectionEnd c) MEMBER_CONST {
  bool far = l.alpha2 < 0.0f;
  vec3 d = far ? l.position : c.position - l.position;
  float d2 = max(dot(d, d), 1e-30f);
  vec3 w = d * inverse_root(d2);
  float sent = far || is_zero(l.facing) ? 1.0f : dot(l.facing, w);
  float met = is_zero(c.facing) ? 1.0f : -dot(c.facing, w);
  if (!(sent > 0.0f && met > 0.0f)) return 0.0f;
  vec3 brought = roughly_scattered(l, w) * roughly_scattered(c, -w);
  return min(luminance(brought) * sent * met * reciprocal(d2), 1e30f);
}

// Lists the ends of light walks for connections, cache by cache, with the data that estimates need
// [connection_estimates.h].

/// Of a light vertex that can be connected.
SHARED void list_end(uint slot) MEMBER {
  PathDensity d = load_path_density(slot);
  if ((d.flags & VERTEX_THERE) == 0u || (d.flags & VERTEX_CONNECTIBLE) == 0u) return;
  PathVertex v = load_path_vertex(slot);
  ConnectionEnd end = connection_end(kept_point(slot, v), v.back, v.throughput, slot, number_of(d));
  connection_ends[scattered_ends() + load_end_first(v.walk) + v.ordinal] = end;
}
/// Of y_0 of a light walk.
SHARED void list_start(uint walk) MEMBER {
  PathVertex v = load_path_vertex(walk);
  PathDensity d = load_path_density(walk);
  if ((d.flags & VERTEX_THERE) == 0u) return;
  Point y0 = kept_point(walk, v);
  ConnectionEnd end = connection_end(y0, v.back, v.throughput, walk, 0u);
  // About what leaves it; the exact direction is evaluated once it is chosen.
  vec3 straight = at_infinity(y0) ? y0.position : y0.normal;
  end.carried = v.throughput * emitted(y0, straight);
  end.facing = v.facing;
  if (at_infinity(y0)) end.alpha2 = -1.0f;
  connection_ends[walk] = end;
}

#include "shaders/shared/language_end.h"
