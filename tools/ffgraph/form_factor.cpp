#include "tools/ffgraph/form_factor.h"

#include <array>
#include <numbers>
#include <vector>

#include "libcommon/math/warp.h"

namespace tdpt {
namespace {

std::vector<Vec3d> points_on(const FacingTriangle& t, int n, Rng& rng) {
  std::vector<Vec3d> points;
  for (int k = 0; k < n; ++k) {
    const double u = rng.uniform();
    const double v = rng.uniform();
    double b1, b2;
    uniform_triangle(u, v, b1, b2);
    points.push_back(t.p0 + t.e1 * b1 + t.e2 * b2);
  }
  return points;
}

}  // namespace

FacingTriangle facing(const Scene& scene, uint32_t face) {
  const TriangleShape s = shape_of(scene, face / 2);
  return {s.p0, s.e1, s.e2, face & 1 ? -s.normal : s.normal, s.area};
}

double form_factor(const FacingTriangle& i, const FacingTriangle& j, int n, int m, Rng& rng,
                   const Tracer* tracer) {
  const std::vector<Vec3d> on_i = points_on(i, n, rng);
  const std::vector<Vec3d> on_j = points_on(j, m, rng);
  double sum = 0;
  for (const Vec3d& x : on_i)
    for (const Vec3d& y : on_j) {
      const Vec3d d = y - x;
      const double r2 = dot(d, d);
      // cos_i cos_j / r^2 = (n_i . d) (-n_j . d) / r^4; cosines before visibility.
      const double at_i = dot(i.normal, d), at_j = -dot(j.normal, d);
      if (!(at_i > 0 && at_j > 0)) continue;
      if (tracer && !tracer->visible({x, i.normal}, {y, j.normal})) continue;
      sum += at_i * at_j / (r2 * r2);
    }
  // [eq. 10]
  return j.area * sum / (std::numbers::pi * n * m);
}

}  // namespace tdpt
