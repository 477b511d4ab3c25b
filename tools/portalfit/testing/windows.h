// Test only: light through windows in the walls of a room, and probes of the space between.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "libcommon/formats/light_grid.h"
#include "libcommon/math/rng.h"

namespace tdpt::testing {

/// A rectangle in a wall of no thickness: centre, half axes, direction of the light.
struct Window {
  Vec3d middle, u, v, n;

  bool holds(const Vec3d& p) const {
    const Vec3d d = p - middle;
    return std::abs(dot(d, u)) <= dot(u, u) && std::abs(dot(d, v)) <= dot(v, v) &&
           std::abs(dot(d, n)) < 1e-9;
  }
};

/// The room -3 <= x <= 0, -3 <= y <= 0, -1 <= z <= 1 [metres]; `windows` lie in its walls.
struct RoomWithWindows {
  static constexpr double kOutside = 2;  // length of a line before a window [metres]
  std::vector<Window> windows;

  /// End of a ray from within; `leaves`: it passes a window.
  Vec3d end_of(const Vec3d& p, const Vec3d& w, bool& leaves) const {
    const Vec3d low{-3, -3, -1}, high{0, 0, 1};
    double reach = INFINITY;
    int wall = 0;
    for (int c = 0; c < 3; ++c)
      if (const double t = ((w[c] > 0 ? high : low)[c] - p[c]) / w[c]; w[c] != 0 && t < reach)
        reach = t, wall = c;
    Vec3d at = p + w * reach;
    at[wall] = (w[wall] > 0 ? high : low)[wall];
    leaves =
        std::any_of(windows.begin(), windows.end(), [&](const Window& o) { return o.holds(at); });
    return leaves ? at + w * kOutside : at;
  }

  /// `lines` through the windows in turn, cosine directions within `widest` of the normal [sine];
  /// probes in any direction through points on them.
  LightGrid light(size_t lines, size_t probes, double widest = 1) const {
    LightGrid grid;
    grid.bottleneck = true;
    for (uint64_t i = 0; grid.lines.size() < lines; ++i) {
      Rng rng(21, 1, i);
      const Window& o = windows[i % windows.size()];
      const double a = 2 * rng.uniform() - 1, b = 2 * rng.uniform() - 1;
      const double c = rng.uniform() * widest * widest, d = rng.uniform();
      const Vec3d p = o.middle + o.u * a + o.v * b;
      const double r = std::sqrt(c), t = 6.283185307179586 * d;
      const Vec3d w =
          Onb<double>(o.n).to_world({r * std::cos(t), r * std::sin(t), std::sqrt(1 - c)});
      bool leaves;
      const Vec3d end = end_of(p + w * 1e-6, w, leaves);
      if (!leaves) grid.lines.push_back({p - w * kOutside, end});
    }
    for (uint64_t i = 0; grid.probes.size() < probes; ++i) {
      Rng rng(21, 2, i);
      const LightLine& line = grid.lines[rng.below(static_cast<uint32_t>(grid.lines.size()))];
      const Vec3d way = line.camera - line.light;
      const double inside = kOutside / length(way), part = rng.uniform();
      const double z = 2 * rng.uniform() - 1, t = 6.283185307179586 * rng.uniform();
      const double r = std::sqrt(1 - z * z);
      const Vec3d w{r * std::cos(t), r * std::sin(t), z};
      const Vec3d p = line.light + way * (inside + (1 - inside) * (0.01 + 0.98 * part));
      bool from_outside, leaves;
      const Vec3d from = end_of(p, -w, from_outside), to = end_of(p, w, leaves);
      if (!leaves) grid.probes.push_back({{from, to}, from_outside});
    }
    fill(grid);
    return grid;
  }

 private:
  // Voxels of the box around the lines.
  static void fill(LightGrid& g) {
    Vec3d low(INFINITY), high(-INFINITY);
    for (const LightLine& l : g.lines)
      low = min(low, min(l.light, l.camera)), high = max(high, max(l.light, l.camera));
    g.voxel = max_component(high - low) / 64;
    g.origin = low;
    size_t n = 1;
    for (int c = 0; c < 3; ++c) {
      const int side = std::max(1, static_cast<int>(std::ceil((high - low)[c] / g.voxel)));
      g.dim[static_cast<size_t>(c)] = side;
      n *= static_cast<size_t>(side);
    }
    g.count.assign(n, 0), g.direction.assign(n, {});
    for (const LightLine& l : g.lines)
      walk_grid(g, l.light, l.camera, [&](size_t v, double) { ++g.count[v]; });
  }
};

}  // namespace tdpt::testing
