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

constexpr int kDirections = 64, kSteps = 40;  // of trimming

// Cuts off parts of the hull that hold far fewer points than their area: light that comes around
// the edge of the aperture. Removes the same from `points`, never more than the share
// `most_trimmed`.
Polygon trimmed(Polygon hull, std::vector<Vec2d>& points, const FitLimits& limits) {
  const double all = static_cast<double>(points.size());
  for (;;) {
    const double whole = area(hull), n = static_cast<double>(points.size());
    const auto most = static_cast<size_t>(std::max(0.0, limits.most_trimmed * all - (all - n)));
    struct Cut {
      double gain;
      Polygon kept;
    };
    std::array<Cut, kDirections> cuts;
    cuts.fill({limits.slight, {}});
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
        const double value =
            (whole - area(kept)) / whole - limits.sparse * static_cast<double>(cut) / n;
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

}  // namespace

Bundle lines_across(const Bundle& lines, const Aperture& a) {
  const Slab slab(a.tube);
  return lines.where([&](const LightLine& line) {
    const auto passage = slab.passage(line);
    return passage && contains(a.polygon, passage->at(0));
  });
}

Polygon outline_of(std::vector<Vec2d> points, const FitLimits& limits) {
  Polygon hull = convex_hull(points);
  if (hull.size() < 3 || !(area(hull) > 0)) return {};
  hull = trimmed(std::move(hull), points, limits);
  return simplified(completed(hull, points.size()), limits.slight);
}

Polygon whole_outline(const std::vector<Vec2d>& points, const FitLimits& limits) {
  const Polygon hull = convex_hull(points);
  if (hull.size() < 3 || !(area(hull) > 0)) return {};
  return simplified(completed(hull, points.size()), limits.slight);
}

std::optional<Aperture> outlined(const FitInput& in, const Bundle& lines, const Tube& tube,
                                 bool again) {
  Aperture a{tube, {}, {}};
  Bundle bundle;
  for (int round = 0; round < 3; ++round) {
    if (round > 0) a.tube = least_tube(bundle.lines(), a.tube, again || round > 1, in.limits);
    bundle = members(lines, a.tube, in.grid.voxel, in.limits);
    if (in.limits.few(bundle.size())) return {};
  }
  if (const auto square = tube_in_wall(bundle.lines(), a.tube, in.grid.walls, in.limits)) {
    a.tube = *square;
    bundle = members(lines, a.tube, in.grid.voxel, in.limits);
    if (in.limits.few(bundle.size())) return {};
  }

  std::vector<Vec2d> points;
  const Slab slab(a.tube);
  for (const uint32_t l : bundle.which)
    if (const auto passage = slab.passage(bundle.line(l)))
      for (const double face : {-in.limits.within * a.tube.half, in.limits.within * a.tube.half})
        points.push_back(passage->at(face));
  a.polygon = outline_of(std::move(points), in.limits);
  if (a.polygon.empty()) return {};
  a.lines = lines_across(lines, a);
  return a;
}

std::optional<Tube> find_waist(const FitInput& in, const Bundle& lines) {
  Tube tube;
  Plane& plane = tube.middle;
  plane.o = fullest_place(in.grid, lines);
  plane.n = mean_direction_near(lines, plane.o, 1.5 * in.grid.voxel);
  if (plane.n == Vec3d{}) return {};
  tube.half = 0.5 * in.grid.voxel;
  for (int round = 0; round < 6; ++round) {
    const Plane before = plane;
    const Bundle bundle = members(lines, tube, in.grid.voxel, in.limits);
    if (in.limits.few(bundle.size())) return {};
    plane = waist(bundle, plane, in.limits);
    if (dot(before.n, plane.n) > 1 - 1e-6 && length(before.o - plane.o) < 1e-3 * in.grid.voxel)
      break;
  }
  return tube;
}

double density_near(const FitInput& in, const Bundle& lines, const Tube& tube) {
  const Bundle bundle = members(lines, tube, in.grid.voxel, in.limits);
  if (in.limits.few(bundle.size())) return 0;
  std::vector<Vec2d> places;
  for (const uint32_t l : bundle.which)
    if (const auto at = crossing(tube.middle, bundle.line(l))) places.push_back(*at);
  const double det = trimmed_moments(places).determinant();
  if (!(det > 0)) return 0;
  // The rectangle with these moments has 12 sqrt(det).
  return static_cast<double>(places.size()) / (12 * std::sqrt(det));
}

std::optional<Aperture> find_aperture(const FitInput& in, const Bundle& lines) {
  const auto tube = find_waist(in, lines);
  return tube ? outlined(in, lines, *tube) : std::nullopt;
}

}  // namespace tdpt
