#include "tools/lightgrid/air.h"

#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tdpt {

bool triangle_touches_box(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& half) {
  const auto apart = [&](const Vec3d& axis) {
    const double pa = dot(axis, a), pb = dot(axis, b), pc = dot(axis, c);
    const double r =
        half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
    return std::min({pa, pb, pc}) > r || std::max({pa, pb, pc}) < -r;
  };
  const Vec3d axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec3d& axis : axes)
    if (apart(axis)) return false;
  const Vec3d edges[3] = {b - a, c - b, a - c};
  if (apart(cross(edges[0], edges[1]))) return false;
  for (const Vec3d& edge : edges)
    for (const Vec3d& axis : axes)
      if (apart(cross(edge, axis))) return false;
  return true;
}

namespace {

struct Box {
  std::array<int, 3> low, high;  // range of voxel indices, high excluded
};

bool is_air(const LightGrid& grid, int i, int j, int k) {
  return __atomic_load_n(&grid.air[grid.index(i, j, k)], __ATOMIC_RELAXED) != 0;
}

// Whether a small box contains no air any more, so that it can be skipped; large boxes are not
// scanned.
bool all_taken(const LightGrid& grid, const Box& box) {
  int voxels = 1;
  for (size_t c = 0; c < 3; ++c) voxels *= box.high[c] - box.low[c];
  if (voxels > 8) return false;
  for (int k = box.low[2]; k < box.high[2]; ++k)
    for (int j = box.low[1]; j < box.high[1]; ++j)
      for (int i = box.low[0]; i < box.high[0]; ++i)
        if (is_air(grid, i, j, k)) return false;
  return true;
}

// Halves the box down to single voxels: a large slanted triangle then costs its surface, not its
// box.
void take(LightGrid& grid, const Vec3d (&p)[3], const Box& box) {
  if (all_taken(grid, box)) return;
  Vec3d middle, half;
  int widest = 0;
  for (int c = 0; c < 3; ++c) {
    const auto s = static_cast<size_t>(c);
    middle[c] = 0.5 * (box.low[s] + box.high[s]);
    half[c] = 0.5 * (box.high[s] - box.low[s]) + 1e-6;  // contact counts, despite rounding
    if (box.high[s] - box.low[s] >
        box.high[static_cast<size_t>(widest)] - box.low[static_cast<size_t>(widest)])
      widest = c;
  }
  if (!triangle_touches_box(p[0] - middle, p[1] - middle, p[2] - middle, half)) return;
  const auto w = static_cast<size_t>(widest);
  if (box.high[w] - box.low[w] == 1) {
    __atomic_store_n(&grid.air[grid.index(box.low[0], box.low[1], box.low[2])], uint8_t{0},
                     __ATOMIC_RELAXED);
    return;
  }
  const int split = (box.low[w] + box.high[w]) / 2;
  Box first = box, second = box;
  first.high[w] = second.low[w] = split;
  take(grid, p, first);
  take(grid, p, second);
}

}  // namespace

void mark_air(const Scene& scene, LightGrid& grid) {
  grid.air.assign(grid.count.size(), 1);
  tbb::parallel_for(
      tbb::blocked_range<uint32_t>(0, static_cast<uint32_t>(scene.triangles.size()), 256),
      [&](const auto& range) {
        for (uint32_t t = range.begin(); t < range.end(); ++t) {
          Vec3d p[3];
          for (int v = 0; v < 3; ++v)
            p[v] = (scene.frame.to_metres(Vec3d(scene.vertex(t, v))) - grid.origin) / grid.voxel;
          const Vec3d low = min(p[0], min(p[1], p[2])), high = max(p[0], max(p[1], p[2]));
          Box box;
          bool empty = false;
          for (int c = 0; c < 3; ++c) {
            const auto s = static_cast<size_t>(c);
            box.low[s] = std::max(0, static_cast<int>(std::floor(low[c] - 1e-6)));
            box.high[s] = std::min(grid.dim[s], static_cast<int>(std::floor(high[c] + 1e-6)) + 1);
            empty = empty || box.low[s] >= box.high[s];
          }
          if (!empty) take(grid, p, box);
        }
      });
}

}  // namespace tdpt
