// Directional albedo of the specular lobe with Schlick's F, E = f0 a + f90 b: the tables of
// tools/tdpt-render/path/bsdf/interface_albedo.cpp, linear between nodes in mu^(1/4) and
// alpha^(1/4).
//
// Read within a scope that has load_surface_curve(); fresnel.h and surface_layout.h come before.

#include "shaders/shared/language.h"

/// E = f0 a + f90 b.
struct InterfaceAlbedo {
  float a;
  float b;
};

/// Node below x^(1/4), x in [0,1], and the way from it to the next.
SHARED uint interface_node(float x, uint nodes, OUT(float) rest) MEMBER_CONST {
  float t = root(root(min(max(x, 0.0f), 1.0f))) * float(nodes - 1u);
  uint i = min(uint(t), nodes - 2u);
  rest = t - float(i);
  return i;
}

SHARED InterfaceAlbedo interface_between(uint i, uint j, float rest) MEMBER_CONST {
  InterfaceAlbedo e;
  e.a = load_surface_curve(i) + (load_surface_curve(j) - load_surface_curve(i)) * rest;
  e.b =
      load_surface_curve(i + 1u) + (load_surface_curve(j + 1u) - load_surface_curve(i + 1u)) * rest;
  return e;
}

/// At cosine `mu` in [0,1] to the normal; alpha in [0,1].
SHARED InterfaceAlbedo interface_albedo(float mu, float alpha) MEMBER_CONST {
  InterfaceAlbedo e;
  if (!(alpha > 0.0f)) {
    FresnelCurve f = schlick_curve(mu);
    e.a = f.rest;
    e.b = f.part;
    return e;
  }
  float s;
  float t;
  uint k = interface_node(alpha, kInterfaceAlphas, s);
  uint i = 2u * (k * kInterfaceCosines + interface_node(mu, kInterfaceCosines, t));
  uint j = i + 2u * kInterfaceCosines;
  InterfaceAlbedo low = interface_between(i, i + 2u, t);
  InterfaceAlbedo high = interface_between(j, j + 2u, t);
  e.a = low.a + (high.a - low.a) * s;
  e.b = low.b + (high.b - low.b) * s;
  return e;
}

/// Average over cosine-distributed directions.
SHARED InterfaceAlbedo interface_albedo_average(float alpha) MEMBER_CONST {
  InterfaceAlbedo e;
  e.a = 0.952380952f;
  e.b = 0.0476190476f;
  if (!(alpha > 0.0f)) return e;
  float s;
  uint k = kInterfaceAverages + 2u * interface_node(alpha, kInterfaceAlphas, s);
  return interface_between(k, k + 2u, s);
}

#include "shaders/shared/language_end.h"
