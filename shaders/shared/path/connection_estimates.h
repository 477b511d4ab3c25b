// Estimates the contribution of two ends of walks, without visibility, to choose which pairs get a
// ray. The same as tools/tdpt-render/path/sample/connect.cpp.
//
// Between diffuse ends only rounding differs from the exact value; for glossy ends masking and the
// Fresnel curve are approximate. Half of the probability is spread equally, so that nothing is lost
// where an estimate is too small, and a chosen pair is divided by its probability.
#ifndef TDPT_SHADERS_SHARED_PATH_JOINS_H
#define TDPT_SHADERS_SHARED_PATH_JOINS_H

#include "shaders/shared/path/point.h"
#include "shaders/shared/path/render_layout.h"

#include "shaders/shared/language.h"

SHARED_BEGIN

/// The end of a walk with this throughput that arrived along -back.
SHARED ConnectionEnd connection_end(Point p, vec3 back, vec3 throughput, uint slot, uint number) {
  const float kInvPi = 0.318309886f;
  ConnectionEnd e;
  e.position = p.position;
  e.slot = slot;
  e.number = number;
  bool transmits = !p.simple && largest(p.bsdf.through) > 0.0f;
  bool begins = is_zero(back);
  vec3 side = dot(p.normal, back) > 0.0f ? p.normal : -p.normal;
  e.facing = begins || transmits ? vec3(0.0f, 0.0f, 0.0f) : side;
  e.back = back;
  e.normal = side;
  e.alpha2 = 0.0f;
  e.cosine = 1.0f;
  e.f0 = vec3(0.0f, 0.0f, 0.0f);
  e.more = vec3(0.0f, 0.0f, 0.0f);
  e.light0 = 0.0f;
  e.light1 = 0.0f;
  e.light2 = 0.0f;
  if (p.simple || begins) {
    e.carried = throughput * (begins ? vec3(1.0f, 1.0f, 1.0f) : p.color) * kInvPi;
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
  e.carried = throughput * (p.bsdf.diffuse * left + above) * kInvPi;
  return e;
}

/// Scattering of an end along unit w: its diffuse lobe and that of the interface.
SHARED vec3 roughly_scattered(ConnectionEnd e, vec3 w) {
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
SHARED float estimate_connection(ConnectionEnd l, ConnectionEnd c) {
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

SHARED_END

#include "shaders/shared/language_end.h"

#endif
