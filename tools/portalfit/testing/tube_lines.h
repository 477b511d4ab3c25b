// Test only: light through an opening in a thick wall.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/rng.h"

namespace tdpt::testing {

/// Lines through the middle of a rectangular tube, a x b x 2 half, along +x about the origin; those
/// that hit its wall end there, as on the jambs of an opening, the others 3 m away.
inline std::vector<LightLine> lines_of_tube(double a, double b, double half, size_t n) {
  std::vector<LightLine> lines;
  for (uint64_t i = 0; i < n; ++i) {
    Rng rng(3, 4, i);
    const double y = a * (rng.uniform() - 0.5), z = b * (rng.uniform() - 0.5);
    const double u = rng.uniform(), v = rng.uniform();
    const Vec3d d = cosine_hemisphere(u, v), w{d.z, d.x, d.y};
    const auto end = [&](double way) {
      double reach = 3;
      const auto wall = [&](double at, double slope, double size) {
        const double t = (std::copysign(0.5 * size, slope) - at) / slope;
        if (t * w.x < half) reach = std::min(reach, t);
      };
      wall(y, way * w.y, a);
      wall(z, way * w.z, b);
      return Vec3d{0, y, z} + w * (way * reach);
    };
    lines.push_back({end(-1), end(1)});
  }
  return lines;
}

}  // namespace tdpt::testing
