// What lies above the diffuse lobe of a surface: the reflecting interface's albedo, sheen, and the
// clear coat. Their lobes are put together in bsdf.h and scatter.h.
//
// Include in a scope that has load_surface_curve() and load_sheen_curve(), after microfacet.h,
// real.h and surface_layout.h.
//
// Directional albedo of a reflecting interface, which it takes away from the layers under it:
// specular lobe with Schlick's F = f0 + (f90 - f0)(1 - c)^5,
//   E(mu) = f0 A(mu, alpha) + f90 B(mu, alpha),   E_avg = 2 int E(mu) mu dmu.
// A and B come from a table [tools/tdpt-render/path/bsdf/surface_curves.cpp], linear between nodes
// in mu^(1/4) and alpha^(1/4), error below 0.002 where mu > 0.05; its averages are those of the
// linear interpolant, so that int (1 - E) mu dmu is exact. alpha = 0 is Schlick's curve itself.

#include "shaders/shared/language.h"

/// E = f0 a + f90 b.
struct InterfaceAlbedo {
  REAL a;
  REAL b;
};

/// Table node below x^(1/4), x in [0,1], and the fraction of the way to the next.
SHARED uint interface_node(REAL x, uint nodes, OUT(REAL) rest) MEMBER_CONST {
  REAL t = root(root(min(max(x, 0.0f), 1.0f))) * REAL(nodes - 1u);
  uint i = min(uint(t), nodes - 2u);
  rest = t - REAL(i);
  return i;
}

SHARED InterfaceAlbedo interface_between(uint i, uint j, REAL rest) MEMBER_CONST {
  InterfaceAlbedo e;
  e.a = load_surface_curve(i) + (load_surface_curve(j) - load_surface_curve(i)) * rest;
  e.b =
      load_surface_curve(i + 1u) + (load_surface_curve(j + 1u) - load_surface_curve(i + 1u)) * rest;
  return e;
}

/// The table row of alpha in (0,1], for use with many cosines.
struct InterfaceRow {
  uint node;
  REAL rest;
};
SHARED InterfaceRow interface_row(REAL alpha) MEMBER_CONST {
  InterfaceRow row;
  row.node = interface_node(alpha, kInterfaceAlphas, row.rest);
  return row;
}

/// At cosine `mu` in [0,1] to the normal.
SHARED InterfaceAlbedo interface_albedo_in(InterfaceRow row, REAL mu) MEMBER_CONST {
  REAL t;
  uint i = 2u * (row.node * kInterfaceCosines + interface_node(mu, kInterfaceCosines, t));
  uint j = i + 2u * kInterfaceCosines;
  InterfaceAlbedo low = interface_between(i, i + 2u, t);
  InterfaceAlbedo high = interface_between(j, j + 2u, t);
  InterfaceAlbedo e = {low.a + (high.a - low.a) * row.rest, low.b + (high.b - low.b) * row.rest};
  return e;
}
SHARED InterfaceAlbedo smooth_interface_albedo(REAL mu) MEMBER_CONST {
  OF_REAL(FresnelCurve) f = schlick_curve(mu);
  InterfaceAlbedo e = {f.rest, f.part};
  return e;
}
/// alpha in [0,1].
SHARED InterfaceAlbedo interface_albedo(REAL mu, REAL alpha) MEMBER_CONST {
  if (!(alpha > 0.0f)) return smooth_interface_albedo(mu);
  return interface_albedo_in(interface_row(alpha), mu);
}

/// Average over cosine-distributed directions.
SHARED InterfaceAlbedo interface_average_in(InterfaceRow row) MEMBER_CONST {
  uint k = kInterfaceAverages + 2u * row.node;
  return interface_between(k, k + 2u, row.rest);
}
SHARED InterfaceAlbedo smooth_interface_average() MEMBER_CONST {
  InterfaceAlbedo e = {REAL(0.952380952380952381), REAL(0.0476190476190476190)};
  return e;
}

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
  SheenMasking m = {REAL(21.5473) + t * REAL(3.7772), REAL(3.82987) - t * REAL(0.50552),
                    REAL(0.19823) - t * REAL(0.03022), REAL(-1.97760) + t * REAL(0.70367),
                    REAL(-4.32054) - t * REAL(0.53913)};
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

// Clear coat as in KHR_materials_clearcoat: a colourless dielectric of index 1.5 above the other
// layers, with its own roughness and normal.
//
// Directions are unit and in the coat's frame: z along its normal, on the side of `from`.
// Lobe: strength F D G2 / (4 cos cos), F = 0.04 + 0.96 (1 - c)^5, single scattering [microfacet.h].
// The coat transmits 1 - E along each of two directions, E its directional albedo. Layers below are
// scaled by the lesser of the two, except a diffuse lobe [bsdf.h]. The format uses the view
// direction alone, which is not reciprocal.

SHARED bool coat_smooth(IN(Coat) c) MEMBER_CONST {
  return c.alpha < kSmoothAlpha;
}

SHARED REAL coat_fresnel(REAL c) MEMBER_CONST {
  return REAL(0.04) + REAL(0.96) * schlick_curve(c).part;
}

/// 1 - E at cosine `mu`, of either sign.
SHARED REAL coat_left_over(IN(Coat) c, REAL mu) MEMBER_CONST {
  InterfaceAlbedo e = interface_albedo(min(abs(mu), 1.0f), coat_smooth(c) ? 0.0f : REAL(c.alpha));
  return 1.0f - c.strength * (REAL(0.04) * e.a + e.b);
}

/// The half vector and its cosine to both directions; false if there is none.
SHARED bool coat_half_vector(IN(Coat) c, VEC3 from, VEC3 to, OUT(VEC3) h,
                             OUT(REAL) cosine) MEMBER_CONST {
  h = from + to;
  cosine = 0.0f;
  if (coat_smooth(c) || !(from.z > kRoughGrazing) || !(to.z > kRoughGrazing)) return false;
  h = normalized(h);
  cosine = dot(from, h);
  return cosine > 0.0f;
}

/// The lobe, unless it is Dirac; colourless [1/sr].
SHARED REAL coat_f(IN(Coat) c, VEC3 from, VEC3 to) MEMBER_CONST {
  VEC3 h;
  REAL cosine;
  if (!coat_half_vector(c, from, to, h, cosine)) return 0.0f;
  return c.strength * coat_fresnel(min(cosine, 1.0f)) * ggx_d(h, REAL(c.alpha)) *
         ggx_g2_over_cos(from.z, to.z, REAL(c.alpha)) * 0.25f;
}

/// Density of that lobe once the coat is chosen [1/sr].
SHARED REAL coat_pdf_w(IN(Coat) c, VEC3 from, VEC3 to) MEMBER_CONST {
  VEC3 h;
  REAL cosine;
  if (!coat_half_vector(c, from, to, h, cosine)) return 0.0f;
  return ggx_d(h, REAL(c.alpha)) * ggx_g1_over_cos(from.z, REAL(c.alpha)) * 0.25f;
}

/// Reflects `from`, by a Dirac lobe if smooth. False if a facet sends it into the surface.
SHARED bool coat_turn(IN(Coat) c, VEC3 from, REAL u, REAL v, OUT(VEC3) to) MEMBER_CONST {
  to = VEC3(-from.x, -from.y, from.z);
  if (coat_smooth(c)) return from.z > kInSurface;
  if (!(from.z > kRoughGrazing)) return false;
  VEC3 h = ggx_visible_normal(from, REAL(c.alpha), u, v);
  REAL cosine = dot(from, h);
  if (!(h.z > kUprightFacet) || !(cosine > 0.0f)) return false;
  to = normalized(h * (2.0f * cosine) - from);
  return to.z > kRoughGrazing;
}

/// For a smooth coat.
SHARED REAL coat_reflectance(IN(Coat) c, REAL mu) MEMBER_CONST {
  return c.strength * coat_fresnel(min(abs(mu), 1.0f));
}

#include "shaders/shared/language_end.h"
