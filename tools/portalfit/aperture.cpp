// One opening from the lines of a grid: seed, bundle, tube, outline.
//
// Method: fixed-point iteration between members and plane (as k-means or ICP alternate between
// assignment and fit): the lines near a plane give a better plane, which has other lines near it.
// The outline is a convex hull, trimmed of what a few outliers add, and enlarged by what a hull of
// n random points lacks on average (Renyi, Sulanke 1963).
#include "tools/portalfit/aperture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include <oneapi/tbb/parallel_for.h>

#include "tools/portalfit/moments.h"

namespace tdpt {
namespace {

// Not an option, since other values gain nothing: in 33 rooms of 11 kinds (portals_bench --seed
// 4100) 24 corners give the same portals, 6 the same verdicts, 4 fit arches worse (tightness 0.92,
// not 0.98), and all take the same time.
constexpr size_t kMostCorners = 12;
// Share of the area for each corner saved; the second if the opening's lines are known.
constexpr double kCornerTolerance = 0.003, kWholeTolerance = 0.03;
constexpr double kWithin = 0.85;  // of the tube's depth: where the outline is taken
// Clear lines extend this far beyond the tube, in its shorter sides; and the share of lines that
// must be clear for a fit to these alone.
constexpr double kClear = 0.2, kLeastClear = 1.0 / 3;

// Cuts off parts of the hull that hold far fewer points than their area: light that comes around
// the edge of the aperture. Removes the same from `points`, never more than the share kMostCut.
Polygon trimmed(Polygon hull, std::vector<Vec2d>& points) {
  constexpr double kMostCut = 0.02, kSparse = 10, kWorthIt = 0.01;
  constexpr int kDirections = 64, kSteps = 40;
  const double all = static_cast<double>(points.size());
  for (;;) {
    const double whole = area(hull), n = static_cast<double>(points.size());
    const auto most = static_cast<size_t>(std::max(0.0, kMostCut * all - (all - n)));
    struct Cut {
      double gain = kWorthIt;
      Polygon kept;
    };
    std::array<Cut, kDirections> cuts;
    tbb::parallel_for(0, kDirections, [&](int k) {
      Cut& cut_here = cuts[static_cast<size_t>(k)];
      const double angle = 2 * std::numbers::pi * k / kDirections;
      const Vec2d axis{std::cos(angle), std::sin(angle)};
      std::vector<double> reach;
      for (const Vec2d& p : points) reach.push_back(dot(p, axis));
      const size_t deepest = std::min(most + 1, reach.size());
      std::partial_sort(reach.begin(), reach.begin() + static_cast<std::ptrdiff_t>(deepest),
                        reach.end(), std::greater<>());
      for (int step = 1; step <= kSteps; ++step) {
        const size_t cut = most * static_cast<size_t>(step) / kSteps;
        if (cut == 0 || cut >= reach.size()) continue;
        Polygon kept = clipped(hull, axis, reach[cut]);
        const double value = (whole - area(kept)) / whole - kSparse * static_cast<double>(cut) / n;
        if (value > cut_here.gain && kept.size() >= 3) cut_here = {value, std::move(kept)};
      }
    });
    const auto best_cut = std::max_element(
        cuts.begin(), cuts.end(), [](const Cut& a, const Cut& b) { return a.gain < b.gain; });
    const Polygon best = best_cut->kept;
    if (best.empty()) return hull;
    std::erase_if(points, [&](const Vec2d& p) { return !contains(best, p); });
    hull = convex_hull(points);
  }
}

// The hull of n random points lacks about (8/3) ln(n)/n of a quadrilateral's area.
Polygon completed(const Polygon& hull, size_t points) {
  const auto n = static_cast<double>(points);
  return enlarged(hull, 1 + 8.0 / 3 * std::log(n) / n);
}

// Lines that neither begin nor end in the tube or close to it. The others may end on something
// before an opening, such as slats or a sill, and would locate that instead of the wall.
Bundle clear_of(const Bundle& bundle, const Tube& tube) {
  const Slab slab(tube);
  std::vector<Vec2d> places;
  for (const uint32_t l : bundle.which)
    if (const auto p = slab.passage(bundle.line(l))) places.push_back(p->at(0));
  if (places.empty()) return {bundle.of};
  const double far = tube.half + kClear * extents_of(places).shorter;
  return bundle.where([&](const LightLine& line) {
    const auto p = slab.passage(line);
    return p && p->through(far);
  });
}

}  // namespace

Bundle lines_across(const Bundle& lines, const Aperture& a) {
  const Slab slab(a.tube);
  return lines.where([&](const LightLine& line) {
    const auto passage = slab.passage(line);
    return passage && contains(a.polygon, passage->at(0));
  });
}

Polygon outline_of(std::vector<Vec2d> points) {
  Polygon hull = convex_hull(points);
  if (hull.size() < 3 || !(area(hull) > 0)) return {};
  hull = trimmed(std::move(hull), points);
  return simplified(completed(hull, points.size()), kMostCorners, kCornerTolerance);
}

Polygon whole_outline(const std::vector<Vec2d>& points) {
  const Polygon hull = convex_hull(points);
  if (hull.size() < 3 || !(area(hull) > 0)) return {};
  return simplified(completed(hull, points.size()), kMostCorners, kWholeTolerance);
}

std::optional<Aperture> outlined(const LightGrid& grid, const Bundle& lines, const Tube& tube,
                                 bool again) {
  Aperture a{tube, {}, {}};
  Bundle bundle;
  for (int round = 0; round < 3; ++round) {
    if (round > 0) a.tube = least_tube(bundle.lines(), a.tube, again || round > 1);
    bundle = members(lines, a.tube, grid.voxel);
    if (bundle.size() < kFewestLines) return {};
  }
  const Bundle clear = clear_of(bundle, a.tube);
  if (static_cast<double>(clear.size()) > kLeastClear * static_cast<double>(bundle.size()))
    if (const auto lesser = lesser_tube(clear.lines(), a.tube)) {
      a.tube = *lesser;
      bundle = members(lines, a.tube, grid.voxel);
      if (bundle.size() < kFewestLines) return {};
    }
  if (const auto square = tube_in_wall(bundle.lines(), a.tube, grid.walls)) {
    a.tube = *square;
    bundle = members(lines, a.tube, grid.voxel);
    if (bundle.size() < kFewestLines) return {};
  }

  std::vector<Vec2d> points;
  const Slab slab(a.tube);
  for (const uint32_t l : bundle.which)
    if (const auto passage = slab.passage(bundle.line(l)))
      for (const double face : {-kWithin * a.tube.half, kWithin * a.tube.half})
        points.push_back(passage->at(face));
  a.polygon = outline_of(std::move(points));
  if (a.polygon.empty()) return {};
  a.lines = lines_across(lines, a);
  return a;
}

std::optional<Tube> find_waist(const LightGrid& grid, const Bundle& lines) {
  Tube tube;
  Plane& plane = tube.middle;
  plane.o = fullest_place(grid, lines);
  plane.n = mean_direction_near(lines, plane.o, 1.5 * grid.voxel);
  if (plane.n == Vec3d{}) return {};
  tube.half = 0.5 * grid.voxel;
  for (int round = 0; round < 6; ++round) {
    const Plane before = plane;
    const Bundle bundle = members(lines, tube, grid.voxel);
    if (bundle.size() < kFewestLines) return {};
    plane = waist(bundle, plane);
    if (dot(before.n, plane.n) > 1 - 1e-6 && length(before.o - plane.o) < 1e-3 * grid.voxel) break;
  }
  return tube;
}

double density_near(const Bundle& lines, const Tube& tube, double voxel) {
  const Bundle bundle = members(lines, tube, voxel);
  if (bundle.size() < kFewestLines) return 0;
  std::vector<Vec2d> places;
  for (const uint32_t l : bundle.which)
    if (const auto at = crossing(tube.middle, bundle.line(l))) places.push_back(*at);
  const double det = trimmed_moments(places).determinant();
  if (!(det > 0)) return 0;
  // The rectangle with these moments has 12 sqrt(det).
  return static_cast<double>(places.size()) / (12 * std::sqrt(det));
}

std::optional<Aperture> find_aperture(const LightGrid& grid, const Bundle& lines) {
  const auto tube = find_waist(grid, lines);
  return tube ? outlined(grid, lines, *tube) : std::nullopt;
}

}  // namespace tdpt
