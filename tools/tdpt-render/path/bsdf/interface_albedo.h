// How much a reflecting interface takes away from what lies under it.
//
// Directional albedo of the specular lobe with Schlick's F = f0 + (f90 - f0)(1 - c)^5:
//   E(mu) = f0 A(mu, alpha) + f90 B(mu, alpha),   E_avg = 2 int E(mu) mu dmu.
// A and B come from a table made on first need (deterministic, about 20 ms), linear between nodes
// in mu^(1/4) and alpha^(1/4), within 0.002 where mu > 0.05; its averages are those of the linear
// interpolant, so that int (1 - E) mu dmu is exact. alpha = 0 is Schlick's curve itself.
#pragma once

namespace tdpt {

/// E = f0 * a + f90 * b.
struct InterfaceAlbedo {
  double a = 0, b = 0;
};

/// Schlick's (1 - c)^5.
inline double schlick(double cos) {
  const double m = 1 - cos, m2 = m * m;
  return m2 * m2 * m;
}

/// What is known of alpha, for many cosines.
struct InterfaceRow {
  int node = -1;  ///< of the table; -1: not told
  double rest = 0;
  InterfaceAlbedo average{};  ///< interface_albedo_average()
};
/// alpha in (0,1].
InterfaceRow interface_row(double alpha);

/// At cosine `mu` in [0,1] to the normal; alpha in [0,1].
InterfaceAlbedo interface_albedo(double mu, double alpha);
InterfaceAlbedo interface_albedo(double mu, const InterfaceRow& row);
/// Average over cosine-distributed directions.
InterfaceAlbedo interface_albedo_average(double alpha);

}  // namespace tdpt
