// Finds which lines pass one opening together, and where they are closest.
//
// Method: density clustering of their crossings with a plane, as connected cells of a 2D histogram
// above a share of the mean density, three times in finer and whitened coordinates; then a pattern
// search over slide and tilt of the plane for the least
//   log sqrt(det C) - 3 log(n / N)
// with C the covariance of the crossings without outliers, and n of N lines that cross the plane.
#include "tools/portalfit/lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

#include "libcommon/math/reach.h"

namespace tdpt {
namespace {

constexpr double kDenseCell = 0.1;    // of the mean density: least of a cell in the bundle
constexpr double kPointsPerCell = 8;  // of the finer histograms

}  // namespace

std::vector<LightLine> Bundle::lines() const {
  std::vector<LightLine> lines;
  for (const uint32_t l : which) lines.push_back(line(l));
  return lines;
}

Vec3d fullest_place(const LightGrid& grid, const Bundle& bundle) {
  // Voxels beside a jamb are not air, so a narrow slit may have no air voxels: lines are counted in
  // all.
  std::vector<uint32_t> count(grid.count.size(), 0);
  for (const uint32_t l : bundle.which)
    walk_grid(grid, bundle.line(l).light, bundle.line(l).camera,
              [&](size_t voxel, double) { ++count[voxel]; });
  const auto most = std::max_element(count.begin(), count.end());
  return centre_of(grid, static_cast<size_t>(most - count.begin()));
}

bool passes_near(const LightLine& line, const Vec3d& place, double radius) {
  const Vec3d d = line.camera - line.light;
  const double t = std::clamp(dot(place - line.light, d) / dot(d, d), 0.0, 1.0);
  const Vec3d off = line.light + d * t - place;
  return dot(off, off) <= radius * radius;
}

Vec3d mean_direction_near(const Bundle& bundle, const Vec3d& place, double radius) {
  Vec3d sum{};
  for (const uint32_t l : bundle.which) {
    const LightLine& line = bundle.line(l);
    if (passes_near(line, place, radius)) sum += normalize(line.camera - line.light);
  }
  const double norm = length(sum);
  return norm > 0 ? sum / norm : sum;
}

namespace {

using Cell = std::array<int64_t, 2>;

struct HashOfCell {
  size_t operator()(const Cell& c) const {
    return static_cast<size_t>(c[0]) * 0x9e37'79b9'7f4a'7c15 ^ static_cast<size_t>(c[1]);
  }
};

// The cells that hold points, numbered in the order in which they are met.
struct Histogram {
  std::unordered_map<Cell, size_t, HashOfCell> number;
  std::vector<Cell> cells;
  std::vector<double> count;

  size_t number_of(const Cell& cell) {
    const auto [it, is_new] = number.try_emplace(cell, cells.size());
    if (is_new) cells.push_back(cell), count.push_back(0);
    return it->second;
  }
};

// Per cell whether it is one of those connected with the middle, with at least `dense` of the mean
// density.
std::vector<uint8_t> dense_region(const Histogram& histogram, double h, double dense) {
  // Starts at the fullest cell, preferring those near the middle.
  size_t start = 0;
  double most = 0;
  for (size_t c = 0; c < histogram.cells.size(); ++c) {
    const Cell& cell = histogram.cells[c];
    const double x = (static_cast<double>(cell[0]) + 0.5) * h,
                 y = (static_cast<double>(cell[1]) + 0.5) * h;
    const double nearness = histogram.count[c] / (1 + (x * x + y * y) / (4 * h * h));
    if (nearness > most) most = nearness, start = c;
  }
  // The threshold is a share of the mean density seen by a point of the region; repeated, since
  // each depends on the other.
  std::vector<uint8_t> region;
  double least = std::max(1.0, dense * histogram.count[start]);
  for (int pass = 0; pass < 3; ++pass) {
    region.assign(histogram.cells.size(), 0);
    region[start] = 1;
    std::vector<size_t> stack{start};
    double weighted = 0, total = 0;
    while (!stack.empty()) {
      const size_t c = stack.back();
      stack.pop_back();
      const double n = histogram.count[c];
      weighted += n * n, total += n;
      for (int64_t dy = -1; dy <= 1; ++dy)
        for (int64_t dx = -1; dx <= 1; ++dx) {
          const Cell& cell = histogram.cells[c];
          const auto next = histogram.number.find({cell[0] + dx, cell[1] + dy});
          if (next == histogram.number.end() || region[next->second] ||
              histogram.count[next->second] < least)
            continue;
          region[next->second] = 1;
          stack.push_back(next->second);
        }
    }
    least = std::max(1.5, dense * weighted / total);
  }
  return region;
}

}  // namespace

Bundle members(const Bundle& bundle, const Tube& tube, double h) {
  std::vector<uint32_t> found;
  std::vector<Vec2d> points;
  // Lines that end before the middle pile up on the jambs: they do not count where others do.
  std::vector<bool> counts;
  size_t counting = 0;
  const Slab slab(tube);
  for (const uint32_t l : bundle.which)
    if (const auto passage = slab.passage(bundle.line(l))) {
      found.push_back(l);
      points.push_back(passage->at(0));
      counts.push_back(passage->through(0));
      counting += counts.back();
    }
  Bundle kept{bundle.of};
  if (found.empty()) return kept;
  if (counting < kFewestLines) counts.assign(points.size(), true);
  // Later histograms take all points again, since the first may have joined two windows, in
  // coordinates where the region is round: slits are then resolved equally along and across.
  Whitening coordinates;
  std::vector<size_t> cell(points.size());
  for (int round = 0;; ++round) {
    Histogram histogram;
    for (size_t i = 0; i < points.size(); ++i) {
      const Vec2d q = coordinates(points[i]);
      cell[i] =
          histogram.number_of({static_cast<int64_t>(std::clamp(std::floor(q.x / h), -1e15, 1e15)),
                               static_cast<int64_t>(std::clamp(std::floor(q.y / h), -1e15, 1e15))});
      histogram.count[cell[i]] += counts[i];
    }
    const std::vector<uint8_t> region = dense_region(histogram, h, kDenseCell);
    kept.which.clear();
    std::vector<Vec2d> kept_points;
    size_t n = 0;
    for (size_t i = 0; i < points.size(); ++i)
      if (region[cell[i]]) {
        kept.which.push_back(found[i]);
        kept_points.push_back(points[i]);
        n += counts[i];
      }
    if (round == 2) return kept;
    const Extents e = extents_of(kept_points);
    if (!(e.shorter > 0)) return kept;
    coordinates = e.whitening();
    h = std::clamp(std::sqrt(kPointsPerCell / static_cast<double>(std::max<size_t>(n, 1))), 0.01,
                   0.2);
  }
}

// Pattern search over slide and tilt: derivatives of trimmed quantities are too rough.
Plane waist(const Bundle& bundle, const Plane& start) {
  const std::vector<LightLine> lines =
      Bundle{bundle.of, thinned(bundle.which, kRoughLines)}.lines();
  const auto size = static_cast<double>(lines.size());
  std::vector<double> lengths;
  for (const LightLine& line : lines) lengths.push_back(length(line.camera - line.light));
  std::vector<Vec2d> points;
  Moments moments;  // of the last plane
  const auto badness_of = [&](const Plane& plane) -> double {
    points.clear();
    const Slab slab({plane, 0});
    for (size_t i = 0; i < lines.size(); ++i)
      if (const auto passage = slab.passage(lines[i]);
          passage && passage->along >= kGrazing * lengths[i])
        points.push_back(passage->at(0));
    if (static_cast<double>(points.size()) < 0.5 * size || points.size() < 8) return INFINITY;
    moments = trimmed_moments(points);
    const double det = moments.determinant();
    if (!(det > 0)) return INFINITY;
    // Crossings per area, with a higher price for lost lines: far from the waist a plane must not
    // gain by approaching the lines' ends.
    return 0.5 * std::log(det) - kWorthOfKnown * std::log(moments.n / size);
  };
  Plane best = start;
  double least = badness_of(best);
  if (!std::isfinite(least)) return best;
  const double unit = std::pow(moments.determinant(), 0.25);
  best.o = to_space(best, moments.mean);  // centre of rotation: the mean of its crossings
  double slide = unit, tilt = 0.3;
  while (slide > 2e-3 * unit || tilt > 2e-3) {
    bool better = false;
    const std::array<double, 3> moves[] = {{0, 0, slide}, {0, 0, -slide}, {tilt, 0, 0},
                                           {-tilt, 0, 0}, {0, tilt, 0},   {0, -tilt, 0}};
    for (const auto& [a, b, along] : moves) {
      const Onb<double> frame(best.n);
      Plane next{best.o + best.n * along, normalize(best.n + frame.x * a + frame.y * b)};
      const double badness = badness_of(next);
      if (!(badness < least)) continue;
      next.o = to_space(next, moments.mean);
      best = next, least = badness, better = true;
    }
    if (!better) slide *= 0.5, tilt *= 0.5;
  }
  return best;
}

}  // namespace tdpt
