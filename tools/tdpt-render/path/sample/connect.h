// Connects two vertices of walks by an edge: the light that passes along it.
//
// What a vertex contributes is the same for many connections and is kept as its End. A simple
// surface scatters equally to its whole side: between two of them a connection needs two products
// and no root.
#pragma once
#include "tools/tdpt-render/path/light/vertex.h"
#include "tools/tdpt-render/path/sample/world.h"

namespace tdpt {

inline bool black(const Rgb& c) {
  return !(c.x != 0 || c.y != 0 || c.z != 0);
}

struct End {
  const Vertex* vertex;
  Vec3d position;
  Vec3d back;           ///< towards the vertex before, unit if `layered`; 0: light begins here
  Vec3d facing{};       ///< normal on the side of `back`; 0 if `layered` and not `opaque`
  Rgb carried;          ///< throughput, times the BSDF unless `layered`
  bool layered;         ///< scattering depends on the direction, or light begins here
  bool opaque = false;  ///< layered, and scatters only incoming light, only on its own side

  End(const Vertex& v, const Vec3d& back_, const Rgb& throughput)
      : vertex(&v),
        position(v.position),
        back(back_),
        carried(throughput),
        layered(!v.simple || !v.on_surface() || back_ == Vec3d()) {
    opaque = layered && v.on_surface() && back != Vec3d() && !shader::is_positive(v.bsdf.through);
    if (layered && !opaque) return;
    facing = dot(v.normal, back) > 0 ? v.normal : -v.normal;
    if (!layered) carried = carried * bsdf_at(v, back, back);
  }

  /// Whether any light leaves along d, of any length.
  bool faces(const Vec3d& d) const { return facing == Vec3d() || dot(facing, d) > 0; }
};

Rgb connect_layered(const World& world, const End& l, const End& c);

/// Light carried from `l` to `c` and on: throughputs, scattering, G and the transmittance of
/// absorbing solids. No visibility.
inline Rgb connect(const World& world, const End& l, const End& c) {
  const Vec3d d = l.vertex->at_infinity() ? l.position : c.position - l.position;
  if (!l.faces(d) || !c.faces(-d)) return {};
  if (l.layered || c.layered || world.absorbing) return connect_layered(world, l, c);
  const double d2 = dot(d, d);
  const double g = -dot(l.facing, d) * dot(c.facing, d) / (d2 * d2);
  return l.carried * c.carried * static_cast<float>(g);
}

}  // namespace tdpt
