// Sheen of cloth as in KHR_materials_sheen: upright fibres, brightest at grazing angles.
//
// Shading frame, directions unit, on the side of z > 0; h the half vector, a = roughness^2.
//   D(h)    = (2 + 1/a) sin(h)^(1/a) / (2 pi)                         (Estevez & Kulla 2017)
//   V(v, w) = 1 / ((1 + L(v) + L(w)) 4 v_z w_z), L their fitted masking
// At grazing angles and small roughness D V reflects more than it receives. There it is scaled:
//   f(v, w) = D V min(N(v), N(w)),  N = min(1, 1/E0),  E0 the directional albedo of D V,
// which changes nothing where E0 <= 1: at any angle for roughness of at least 0.25. E0 and the
// albedo of f are tables [tools/tdpt-render/path/bsdf/surface_curves.cpp], linear between nodes in
// mu^(1/3) and roughness.
//
// Include in a scope that has load_sheen_curve(), after elementary.h and surface_layout.h.

#include "shaders/shared/language.h"

/// Coefficients of Estevez & Kulla's fit: L = a / (1 + b x^c) + d x + e.
struct SheenMasking {
  REAL a;
  REAL b;
  REAL c;
  REAL d;
  REAL e;
};

SHARED SheenMasking sheen_masking(REAL alpha) MEMBER_CONST {
  REAL t = (1.0f - alpha) * (1.0f - alpha);
  SheenMasking m;
  m.a = REAL(21.5473) + t * REAL(3.7772);
  m.b = REAL(3.82987) - t * REAL(0.50552);
  m.c = REAL(0.19823) - t * REAL(0.03022);
  m.d = REAL(-1.97760) + t * REAL(0.70367);
  m.e = REAL(-4.32054) - t * REAL(0.53913);
  return m;
}
SHARED REAL sheen_fit(SheenMasking m, REAL x) MEMBER_CONST {
  return m.a * reciprocal(1.0f + m.b * power(x, m.c)) + m.d * x + m.e;
}
SHARED REAL sheen_masks(SheenMasking m, REAL cosine) MEMBER_CONST {
  bool steep = cosine < 0.5f;
  REAL own = sheen_fit(m, steep ? cosine : 1.0f - cosine);
  return exponential(steep ? own : 2.0f * sheen_fit(m, 0.5f) - own);
}

/// The table at `first`, linear between nodes in mu^(1/3) and roughness.
SHARED REAL sheen_table(uint first, REAL mu, REAL alpha) MEMBER_CONST {
  REAL x = power(min(max(mu, 0.0f), 1.0f), REAL(0.333333333333333333)) * REAL(kSheenCosines - 1u);
  REAL r = (root(alpha) - kLeastSheenRoughness) * REAL(24.7311827956989247);
  r = min(max(r, 0.0f), REAL(kSheenRoughnesses - 1u));
  uint column = min(uint(x), kSheenCosines - 2u);
  uint row = min(uint(r), kSheenRoughnesses - 2u);
  x = x - REAL(column);
  r = r - REAL(row);
  uint i = first + row * kSheenCosines + column;
  uint j = i + kSheenCosines;
  REAL p = load_sheen_curve(i) + (load_sheen_curve(i + 1u) - load_sheen_curve(i)) * x;
  REAL q = load_sheen_curve(j) + (load_sheen_curve(j + 1u) - load_sheen_curve(j)) * x;
  return p + (q - p) * r;
}

/// D; also valid if v and w are nearly opposite.
SHARED REAL sheen_distribution(VEC3 v, VEC3 w, REAL alpha) MEMBER_CONST {
  VEC3 h = v + w;
  REAL flat_part = h.x * h.x + h.y * h.y;
  REAL sin2 = min(flat_part * reciprocal(max(flat_part + h.z * h.z, 1e-30f)), 1.0f);
  REAL over_alpha = reciprocal(alpha);
  return (2.0f + over_alpha) * power(sin2, 0.5f * over_alpha) * (0.5f * INVERSE_PI);
}
/// V; `masks`: L(v) + L(w).
SHARED REAL sheen_visibility(REAL cos_v, REAL cos_w, REAL masks) MEMBER_CONST {
  return 0.25f * reciprocal((1.0f + masks) * cos_v * cos_w);
}

/// For a white sheen [1/sr]; 0 if a cosine is less than 1e-6.
SHARED REAL sheen_f(VEC3 v, VEC3 w, REAL alpha) MEMBER_CONST {
  if (!(v.z >= 1e-6f) || !(w.z >= 1e-6f)) return 0.0f;
  REAL d = sheen_distribution(v, w, alpha);
  SheenMasking m = sheen_masking(alpha);
  REAL masks = sheen_masks(m, v.z) + sheen_masks(m, w.z);
  REAL visibility = sheen_visibility(v.z, w.z, masks);
  REAL unscaled = max(sheen_table(0u, v.z, alpha), sheen_table(0u, w.z, alpha));
  return d * visibility * (unscaled > 1.0f ? reciprocal(unscaled) : REAL(1.0f));
}

/// Directional albedo at cosine `mu`.
SHARED REAL sheen_albedo(REAL mu, REAL alpha) MEMBER_CONST {
  return sheen_table(kSheenAlbedos, mu, alpha);
}

#include "shaders/shared/language_end.h"
