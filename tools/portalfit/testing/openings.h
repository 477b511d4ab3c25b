// Test only: lines of light through rectangular openings in walls, and the grid that counts them.
#pragma once
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/rng.h"
#include "tools/portalfit/lines.h"

namespace tdpt::testing {

/// A rectangular opening in a wall: centre (in the middle of the wall), half axes u and v,
/// direction of the light, thickness of the wall [metres].
struct Opening {
  Vec3d middle, u, v, n;
  double thickness = 0;
  double share = 1;  ///< of the lines

  double area() const { return 4 * length(u) * length(v); }
  /// Whether the line passes `shift` [metres] before the middle, along n.
  bool passes(const LightLine& line, double shift) const {
    const Vec3d way = line.camera - line.light;
    const double t = (dot(middle - line.light, n) + shift) / dot(way, n);
    const Vec3d d = line.light + way * t - middle;
    return std::abs(dot(d, u)) <= dot(u, u) && std::abs(dot(d, v)) <= dot(v, v);
  }
};

struct Light {
  double reach = 2;   ///< length of a line on either side of the opening
  double lean = 0;    ///< the light comes from one side: directions leaning towards +u
  double strays = 0;  ///< share of lines at random in the whole box
};

/// Points uniform on the openings, cosine directions, lines that a jamb blocks dropped.
inline std::vector<LightLine> lines_through(const std::vector<Opening>& openings, size_t n,
                                            const Light& light = {}, uint64_t seed = 1,
                                            uint32_t cut = 0) {
  std::vector<LightLine> lines;
  for (uint64_t i = 0; lines.size() < n; ++i) {
    Rng rng(seed, 1, i);
    double pick = rng.uniform();
    const double stray = rng.uniform(), a = rng.uniform(), b = rng.uniform();
    const double c = rng.uniform(), d = rng.uniform(), e = rng.uniform(), f = rng.uniform();
    size_t k = 0;
    while (k + 1 < openings.size() && pick >= openings[k].share) pick -= openings[k++].share;
    const Opening& o = openings[k];
    const Onb<double> frame(o.n);
    if (stray < light.strays) {
      const auto place = [&](double x, double y, double z) {
        return o.middle + frame.to_world(Vec3d{x, y, z} * (2 * light.reach) - Vec3d(light.reach));
      };
      lines.push_back({place(a, b, c), place(d, e, f), cut});
      continue;
    }
    const Vec3d p = o.middle + o.u * (2 * a - 1) + o.v * (2 * b - 1);
    const Vec3d w = frame.to_world(cosine_hemisphere(c, d));
    if (dot(w, normalize(o.u)) * light.lean < 0 && e < std::abs(light.lean)) continue;
    const LightLine line{p - w * light.reach, p + w * light.reach, cut};
    if (o.passes(line, 0.5 * o.thickness) && o.passes(line, -0.5 * o.thickness))
      lines.push_back(line);
  }
  return lines;
}

inline LightGrid grid_of(const std::vector<LightLine>& lines, int resolution = 64) {
  LightGrid g;
  Vec3d low(INFINITY), high(-INFINITY);
  for (const LightLine& l : lines) {
    low = min(low, min(l.light, l.camera));
    high = max(high, max(l.light, l.camera));
  }
  g.voxel = max_component(high - low) / resolution;
  g.origin = low;
  size_t n = 1;
  for (int c = 0; c < 3; ++c) {
    const int side = std::max(1, static_cast<int>(std::ceil((high - low)[c] / g.voxel)));
    g.dim[static_cast<size_t>(c)] = side;
    n *= static_cast<size_t>(side);
  }
  g.count.assign(n, 0);
  g.direction.assign(n, {});
  for (const LightLine& l : lines)
    walk_grid(g, l.light, l.camera, [&](size_t v, double) { ++g.count[v]; });
  g.lines = lines;
  return g;
}

/// All lines of a grid as one bundle.
inline Bundle all_of(const LightGrid& grid) {
  Bundle all{&grid.lines, std::vector<uint32_t>(grid.lines.size())};
  std::iota(all.which.begin(), all.which.end(), 0u);
  return all;
}

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
