// Connects two vertices of walks by an edge: the light that passes along it.
//
// What a vertex contributes is the same for many connections and is kept as its End. A simple
// surface scatters equally to its whole side: between two of them a connection needs two products
// and no root.
#pragma once
#include <array>
#include <vector>

#include "tools/tdpt-render/path/bsdf/point.h"
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

// Estimates the connections of many vertices with one, without visibility, for
// light_vertex_cache.h. An estimate is positive wherever connect() is and need not be exact.
//
// Ends are stored in columns (structure of arrays), so that several are computed at once. Between
// simple surfaces an estimate is the value of connect(), by the same operations. For glossy
// surfaces it is an approximation in floats: the interface takes 1 - f0 of the diffuse lobe, and
// bent normals darken nothing.

/// Ends on the light's side of possible connections.
class Ends {
 public:
  // Columns.
  enum Coordinate { x, y, z, facing_x, facing_y, facing_z, kPlaces };
  enum Colour {
    red,
    green,
    blue,
    light_red,
    light_green,
    light_blue,
    // For glossy ends: unit direction back, shading normal on that side, its cosine to back,
    // alpha^2, reflectance at normal incidence, and its increase at grazing incidence.
    back_x,
    back_y,
    back_z,
    normal_x,
    normal_y,
    normal_z,
    cosine,
    alpha2,
    f0_red,
    f0_green,
    f0_blue,
    f90_red,
    f90_green,
    f90_blue,
    kColours
  };

  Ends() = default;
  Ends(Ends&&) = default;  // a copy's columns would point into the original
  Ends& operator=(Ends&&) = default;

  /// Whether an end can be estimated; others still get a place.
  static bool has(const End& end) { return !end.layered || end.opaque; }

  void clear() {
    size_ = 0;
    glossy_ = false;
  }
  void add(const End& end);
  size_t size() const { return size_; }
  /// The light that arrives at end i, a factor of its estimates; 0 unless set.
  void set_light(size_t i, const Rgb& light);

  /// Number of estimates computed at once.
  static constexpr int kLanes = 8;
  /// Size of the output for n ends.
  static size_t room(size_t n) { return (n + kLanes - 1) / kLanes * kLanes; }
  /// out[i]: luminance that end i sends to `c` times its light; `c` must satisfy has(), and entries
  /// of ends that do not, and those after the last up to room(), are undefined.
  void estimate(const End& c, double* out) const;
  /// The same for chosen ends; there must be at least one end.
  void estimate(const End& c, const std::array<int, kLanes>& chosen, double* out) const;

 private:
  struct Columns {
    std::array<const double*, kPlaces> place{};
    std::array<const float*, kColours> colour{};
  };
  struct Gloss;
  void make_place();

  size_t size_ = 0;
  bool glossy_ = false;  // some ends are
  Columns columns_;      // pointers to the vectors below
  std::array<std::vector<double>, kPlaces> place_;
  std::array<std::vector<float>, kColours> colour_;
};

}  // namespace tdpt
