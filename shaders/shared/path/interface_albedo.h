// Directional albedo of a reflecting interface, which it takes away from the layers under it:
// specular lobe with Schlick's F = f0 + (f90 - f0)(1 - c)^5,
//   E(mu) = f0 A(mu, alpha) + f90 B(mu, alpha),   E_avg = 2 int E(mu) mu dmu.
// A and B come from a table [tools/tdpt-render/path/bsdf/surface_curves.cpp], linear between nodes
// in mu^(1/4) and alpha^(1/4), error below 0.002 where mu > 0.05; its averages are those of the
// linear interpolant, so that int (1 - E) mu dmu is exact. alpha = 0 is Schlick's curve itself.
//
// Include in a scope that has load_surface_curve(), after fresnel.h and surface_layout.h.

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
  InterfaceAlbedo e;
  e.a = low.a + (high.a - low.a) * row.rest;
  e.b = low.b + (high.b - low.b) * row.rest;
  return e;
}
SHARED InterfaceAlbedo smooth_interface_albedo(REAL mu) MEMBER_CONST {
  OF_REAL(FresnelCurve) f = schlick_curve(mu);
  InterfaceAlbedo e;
  e.a = f.rest;
  e.b = f.part;
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
  InterfaceAlbedo e;
  e.a = REAL(0.952380952380952381);
  e.b = REAL(0.0476190476190476190);
  return e;
}

#include "shaders/shared/language_end.h"
