// Sheen of cloth in floats [tools/tdpt-render/path/bsdf/sheen.h]: D V min(N(v), N(w)).
//
// Read within a scope that has load_surface_curve(); elementary.h, ggx.h and surface_layout.h come
// before.

#include "shaders/shared/language.h"

/// Of Estevez & Kulla's fit: L = a / (1 + b x^c) + d x + e.
struct SheenMasking {
  float a;
  float b;
  float c;
  float d;
  float e;
};

SHARED SheenMasking sheen_masking(float alpha) MEMBER_CONST {
  float t = (1.0f - alpha) * (1.0f - alpha);
  SheenMasking m;
  m.a = 21.5473f + t * 3.7772f;
  m.b = 3.82987f - t * 0.50552f;
  m.c = 0.19823f - t * 0.03022f;
  m.d = -1.97760f + t * 0.70367f;
  m.e = -4.32054f - t * 0.53913f;
  return m;
}
SHARED float sheen_fit(SheenMasking m, float x) MEMBER_CONST {
  return m.a * reciprocal(1.0f + m.b * power(x, m.c)) + m.d * x + m.e;
}
SHARED float sheen_masks(SheenMasking m, float cosine) MEMBER_CONST {
  bool steep = cosine < 0.5f;
  float own = sheen_fit(m, steep ? cosine : 1.0f - cosine);
  return exponential(steep ? own : 2.0f * sheen_fit(m, 0.5f) - own);
}

/// The table at `first`, linear between nodes in mu^(1/3) and roughness.
SHARED float sheen_table(uint first, float mu, float alpha) MEMBER_CONST {
  float x = power(min(max(mu, 0.0f), 1.0f), 0.333333333f) * float(kSheenCosines - 1u);
  float r = (root(alpha) - 0.07f) * 24.7311828f;
  r = min(max(r, 0.0f), float(kSheenRoughnesses - 1u));
  uint column = min(uint(x), kSheenCosines - 2u);
  uint row = min(uint(r), kSheenRoughnesses - 2u);
  x = x - float(column);
  r = r - float(row);
  uint i = first + row * kSheenCosines + column;
  uint j = i + kSheenCosines;
  float p = load_surface_curve(i) + (load_surface_curve(i + 1u) - load_surface_curve(i)) * x;
  float q = load_surface_curve(j) + (load_surface_curve(j + 1u) - load_surface_curve(j)) * x;
  return p + (q - p) * r;
}

/// For a white sheen [1/sr]; 0 where a cosine is less than 1e-6.
SHARED float sheen_f(vec3 v, vec3 w, float alpha) MEMBER_CONST {
  if (!(v.z >= 1e-6f) || !(w.z >= 1e-6f)) return 0.0f;
  vec3 h = v + w;
  float flat_part = h.x * h.x + h.y * h.y;
  float sin2 = min(flat_part * reciprocal(max(flat_part + h.z * h.z, 1e-30f)), 1.0f);
  float over_alpha = reciprocal(alpha);
  float d = (2.0f + over_alpha) * power(sin2, 0.5f * over_alpha) * (0.5f * kInversePi);
  SheenMasking m = sheen_masking(alpha);
  float masks = sheen_masks(m, v.z) + sheen_masks(m, w.z);
  float visibility = 0.25f * reciprocal((1.0f + masks) * v.z * w.z);
  float unscaled =
      max(sheen_table(kSheenUnscaled, v.z, alpha), sheen_table(kSheenUnscaled, w.z, alpha));
  return d * visibility * (unscaled > 1.0f ? reciprocal(unscaled) : 1.0f);
}

/// Directional albedo at cosine `mu`.
SHARED float sheen_albedo(float mu, float alpha) MEMBER_CONST {
  return sheen_table(kSheenAlbedos, mu, alpha);
}

#include "shaders/shared/language_end.h"
