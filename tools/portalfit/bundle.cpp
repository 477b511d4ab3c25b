// Finds which lines pass one opening together, and where they are closest.
//
// Method: density clustering of their crossings with a plane, as connected cells of a 2D histogram
// above a share of the mean density, three times in finer and whitened coordinates; then a pattern
// search over slide and tilt of the plane for the least
//   log sqrt(det C) - 3 log(n / N)
// with C the covariance of the crossings without outliers, and n of N lines that cross the plane.
#include "tools/portalfit/bundle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "libcommon/math/thinned.h"
#include "tools/portalfit/moments.h"

namespace tdpt {
namespace {

constexpr double kDense = 0.1;        // of the mean density: least of a cell in the aperture
constexpr double kPointsPerCell = 8;  // in the finer histograms
constexpr size_t kMostForMoments = 2000;

Plane tilted(const Plane& plane, double a, double b, double along) {
  const Onb<double> frame(plane.n);
  return {plane.o + plane.n * along, normalize(plane.n + frame.x * a + frame.y * b)};
}

}  // namespace

std::vector<LightLine> Bundle::lines() const {
  std::vector<LightLine> some;
  for (const uint32_t l : which) some.push_back(line(l));
  return some;
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

Vec3d mean_direction_near(const Bundle& bundle, const Vec3d& place, double radius) {
  Vec3d sum{};
  for (const uint32_t l : bundle.which) {
    const LightLine& line = bundle.line(l);
    const Vec3d d = line.camera - line.light;
    const double t = std::clamp(dot(place - line.light, d) / dot(d, d), 0.0, 1.0);
    const Vec3d off = line.light + d * t - place;
    if (dot(off, off) <= radius * radius) sum += normalize(d);
  }
  const double norm = length(sum);
  return norm > 0 ? sum / norm : sum;
}

namespace {

using Cell = std::array<int64_t, 2>;

// The connected cells around the middle with at least kDense of the mean density.
std::set<Cell> dense_region(const std::map<Cell, double>& count, double h) {
  // Starts at the fullest cell, preferring those near the middle.
  Cell start{};
  double most = 0;
  for (const auto& [cell, n] : count) {
    const double x = (static_cast<double>(cell[0]) + 0.5) * h,
                 y = (static_cast<double>(cell[1]) + 0.5) * h;
    const double nearness = n / (1 + (x * x + y * y) / (4 * h * h));
    if (nearness > most) most = nearness, start = cell;
  }
  // The threshold is a share of the mean density seen by a point of the region; repeated, since
  // each depends on the other.
  std::set<Cell> region;
  double least = std::max(1.0, kDense * count.at(start));
  for (int pass = 0; pass < 3; ++pass) {
    region = {start};
    std::vector<Cell> stack{start};
    double weighted = 0, total = 0;
    while (!stack.empty()) {
      const Cell c = stack.back();
      stack.pop_back();
      const double n = count.at(c);
      weighted += n * n, total += n;
      for (int64_t dy = -1; dy <= 1; ++dy)
        for (int64_t dx = -1; dx <= 1; ++dx) {
          const Cell next{c[0] + dx, c[1] + dy};
          const auto it = count.find(next);
          if (it != count.end() && it->second >= least && region.insert(next).second)
            stack.push_back(next);
        }
    }
    least = std::max(1.5, kDense * weighted / total);
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
  for (const uint32_t l : bundle.which)
    if (const auto at = inside_at(tube, bundle.line(l), 0)) {
      found.push_back(l);
      points.push_back(*at);
      counts.push_back(crossing(tube.middle, bundle.line(l)).has_value());
      counting += counts.back();
    }
  Bundle kept{bundle.of};
  if (found.empty()) return kept;
  constexpr size_t kFewest = 30;
  if (counting < kFewest) counts.assign(points.size(), true);
  // Later histograms take all points again, since the first may have joined two windows, in
  // coordinates where the region is round: slits are then resolved equally along and across.
  Whitening coordinates;
  for (int look = 0;; ++look) {
    const auto cell_of = [&](Vec2d p) {
      const Vec2d q = coordinates(p);
      return Cell{static_cast<int64_t>(std::clamp(std::floor(q.x / h), -1e15, 1e15)),
                  static_cast<int64_t>(std::clamp(std::floor(q.y / h), -1e15, 1e15))};
    };
    std::map<Cell, double> count;
    for (size_t i = 0; i < points.size(); ++i)
      if (counts[i]) ++count[cell_of(points[i])];
    const std::set<Cell> region = dense_region(count, h);
    kept.which.clear();
    std::vector<Vec2d> kept_points;
    size_t n = 0;
    for (size_t i = 0; i < points.size(); ++i)
      if (region.contains(cell_of(points[i]))) {
        kept.which.push_back(found[i]);
        kept_points.push_back(points[i]);
        n += counts[i];
      }
    if (look == 2) return kept;
    const Extents e = extents_of(kept_points);
    if (!(e.shorter > 0)) return kept;
    coordinates = e.whitening();
    h = std::clamp(std::sqrt(kPointsPerCell / static_cast<double>(std::max<size_t>(n, 1))), 0.01,
                   0.2);
  }
}

namespace {

// Pattern search over slide and tilt: derivatives of trimmed quantities are too rough.
struct Search {
  std::vector<LightLine> lines;
  Moments moments{};
  std::vector<Vec2d> points{};

  double badness(const Plane& plane) {
    const auto size = static_cast<double>(lines.size());
    points.clear();
    for (const LightLine& line : lines)
      if (const auto at = clear_crossing(plane, line)) points.push_back(*at);
    if (static_cast<double>(points.size()) < 0.5 * size || points.size() < 8) return INFINITY;
    moments = trimmed_moments(points);
    const double det = moments.determinant();
    if (!(det > 0)) return INFINITY;
    const double spread = 0.5 * std::log(det);
    // Crossings per area, with a higher price for lost lines: far from the waist a plane must not
    // gain by approaching the lines' ends.
    return spread - 3 * std::log(moments.n / size);
  }

  Plane run(Plane best, double slide, double tilt) {
    double least = badness(best);
    if (!std::isfinite(least)) return best;
    const double unit = std::pow(moments.determinant(), 0.25);
    slide *= unit;
    best.o = to_space(best, moments.mean);  // centre of rotation: the mean of its crossings
    const bool turns = tilt > 0;
    while (slide > 2e-3 * unit || tilt > 2e-3) {
      bool better = false;
      const std::array<std::array<double, 3>, 6> moves{{{0, 0, slide},
                                                        {0, 0, -slide},
                                                        {tilt, 0, 0},
                                                        {-tilt, 0, 0},
                                                        {0, tilt, 0},
                                                        {0, -tilt, 0}}};
      for (size_t m = 0; m < (turns ? 6u : 2u); ++m) {
        Plane next = tilted(best, moves[m][0], moves[m][1], moves[m][2]);
        const double bad = badness(next);
        if (!(bad < least)) continue;
        next.o = to_space(next, moments.mean);
        best = next;
        least = bad;
        better = true;
      }
      if (!better) slide *= 0.5, tilt *= 0.5;
    }
    return best;
  }
};

}  // namespace

Plane waist(const Bundle& bundle, const Plane& start) {
  const Bundle some{bundle.of, thinned(bundle.which, kMostForMoments)};
  return Search{some.lines()}.run(start, 1, 0.3);
}

}  // namespace tdpt
