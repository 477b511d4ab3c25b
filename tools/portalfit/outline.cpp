#include "tools/portalfit/opening.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <oneapi/tbb/parallel_for.h>

namespace tdpt {
namespace {

// One opening from the lines of a grid: seed, bundle, tube, outline.
//
// Method: fixed-point iteration between members and plane (as k-means or ICP alternate between
// assignment and fit): the lines near a plane give a better plane, which has other lines near it.
// The outline is a convex hull, trimmed of what a few outliers add, and enlarged by what a hull of
// n random points lacks on average (Renyi, Sulanke 1963).

constexpr int kDirections = 64, kSteps = 40;  // of trimming
constexpr double kMostTrimmed = 0.02;         // share of the lines that may be strays
constexpr double kSparse = 10;  // share of the area over that of the lines, where strays are
constexpr double kOutlineDepth = 0.85;  // of a tube's depth: where the outline is taken
constexpr double kDenser = 1.3;         // lines per area of a part over those of the whole

// Cuts off parts of the hull that hold far fewer points than their area: light that comes around
// the edge of the aperture. Removes the same from `points`, never more than the share
// kMostTrimmed.
Polygon trimmed(Polygon hull, std::vector<Vec2d>& points) {
  const double all = static_cast<double>(points.size());
  for (;;) {
    const double whole = area(hull), n = static_cast<double>(points.size());
    const auto most = static_cast<size_t>(std::max(0.0, kMostTrimmed * all - (all - n)));
    struct Cut {
      double gain;
      Polygon kept;
    };
    std::array<Cut, kDirections> cuts;
    cuts.fill({kSlight, {}});
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

}  // namespace

std::vector<Vec3d> corners_of(const Aperture& a) {
  std::vector<Vec3d> corners;
  for (const Vec2d& p : a.polygon) corners.push_back(to_space(a.tube.middle, p));
  return corners;
}

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
  return simplified(completed(hull, points.size()), kSlight);
}

std::optional<Aperture> outlined(const LightGrid& grid, const Bundle& lines, const Tube& tube,
                                 bool again) {
  Aperture a{tube, {}, {}};
  Bundle bundle;
  for (int round = 0; round < 4; ++round) {
    if (round == 1 || round == 2)
      a.tube = least_tube(bundle.lines(), a.tube, again || round > 1);
    else if (round == 3)
      a.tube = turned_into_wall(bundle.lines(), a.tube, grid.walls);
    bundle = members(lines, a.tube, grid.voxel);
    if (bundle.size() < kFewestLines) return {};
  }

  std::vector<Vec2d> points;
  const Slab slab(a.tube);
  for (const uint32_t l : bundle.which)
    if (const auto passage = slab.passage(bundle.line(l)))
      for (const double face : {-kOutlineDepth * a.tube.half, kOutlineDepth * a.tube.half})
        points.push_back(passage->at(face));
  a.polygon = outline_of(std::move(points));
  if (a.polygon.empty()) return {};
  a.lines = lines_across(lines, a);
  return a;
}

namespace {

// The waist around the fullest voxel of `lines`, a voxel deep: where an aperture may be.
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

// Number of the `lines` near `tube` over the area of their crossings with its middle plane,
// outliers left out [1/m2]: a cheap guess at the density of the aperture there; 0 if there is
// none.
double density_near(const LightGrid& grid, const Bundle& lines, const Tube& tube) {
  const Bundle bundle = members(lines, tube, grid.voxel);
  if (bundle.size() < kFewestLines) return 0;
  std::vector<Vec2d> places;
  for (const uint32_t l : bundle.which)
    if (const auto at = crossing(tube.middle, bundle.line(l))) places.push_back(*at);
  const double det = trimmed_moments(places).determinant();
  if (!(det > 0)) return 0;
  // The rectangle with these moments has 12 sqrt(det).
  return static_cast<double>(places.size()) / (12 * std::sqrt(det));
}

}  // namespace

std::optional<Aperture> find_aperture(const LightGrid& grid, const Bundle& lines) {
  const auto tube = find_waist(grid, lines);
  return tube ? outlined(grid, lines, *tube) : std::nullopt;
}

namespace {

// ---- An opening, or a plane in the air or across several openings ----

// Distinguishes an opening from a plane in the air.
//
// Method: a plane across two windows at a corner has fewer lines per area than either of them
// (minimum etendue again); so a denser aperture is sought among its lines to one side.

constexpr int kPlaces = 16;  // along each side of an outline

// Share of the lines through the middle of the tube that pass both its faces.
double through_share(const Aperture& a) {
  const Extents e = extents_of(a.polygon);
  if (!(e.shorter > 0)) return 1;
  const double grow = std::sqrt(area(a.polygon) / (e.longer * e.shorter));
  return facing_rectangles(grow * e.longer, grow * e.shorter, 2 * a.tube.half);
}

double density(const Aperture& a) {
  return static_cast<double>(a.lines.size()) / area(a.polygon);
}

}  // namespace

std::optional<double> support_of(const LightGrid& grid, const Aperture& a) {
  double tried = 0, joined = 0;
  for (const Probe& probe : grid.probes) {
    const LightLine back{probe.line.camera, probe.line.light, probe.line.cut};
    auto at = clear_crossing(a.tube.middle, probe.line);
    if (!at && !probe.joins) at = clear_crossing(a.tube.middle, back);
    if (!at || !contains(a.polygon, *at)) continue;
    ++tried;
    joined += probe.joins;
  }
  if (tried < kFewestLines) return {};
  return std::min(1.0, joined / tried / through_share(a));
}

namespace {

// Whether the middle of the aperture sees `beyond` past a place on its outline through air, both
// moved by `offset` along the normal. Outside the grid all is air.
bool sees_past(const LightGrid& grid, const Aperture& a, Vec2d middle, Vec2d edge, Vec2d beyond,
               double offset) {
  const Plane there{a.tube.middle.o + a.tube.middle.n * offset, a.tube.middle.n};
  bool free = true;
  walk_grid(grid, to_space(there, middle + (edge - middle) * 0.5), to_space(there, edge + beyond),
            [&](size_t voxel, double) { free = free && grid.air[voxel]; });
  return free;
}

}  // namespace

std::optional<double> edge_share(const LightGrid& grid, const Aperture& a) {
  const double size = std::sqrt(area(a.polygon));
  const bool no_walls = std::find(grid.air.begin(), grid.air.end(), 0) == grid.air.end();
  if (no_walls || size < 2 * kResolved * grid.voxel) return {};
  // How far past the outline is looked: a wall may stand apart from it, or reach little beyond it.
  const double apart = std::max(kResolved * grid.voxel, kBeside * size),
               close = std::min(apart, 2 * kResolved * grid.voxel), far = a.tube.half + 0.5 * size;
  const Vec2d middle = extents_of(a.polygon).mean;
  double before = 0, behind = 0, all = 0;
  for (size_t i = 0; i < a.polygon.size(); ++i) {
    const Vec2d from = a.polygon[i], side = a.polygon[(i + 1) % a.polygon.size()] - from;
    const double length = std::sqrt(dot(side, side));
    if (!(length > 0)) continue;
    const Vec2d out = Vec2d{side.y, -side.x} * (1 / length);
    for (int k = 0; k < kPlaces; ++k) {
      const Vec2d edge = from + side * ((k + 0.5) / kPlaces);
      const auto ends_here = [&](double offset, double beyond) {
        return !sees_past(grid, a, middle, edge, out * beyond, 0) &&
               sees_past(grid, a, middle, edge, out * beyond, offset);
      };
      all += length;
      if (ends_here(-far, apart) || ends_here(-far, close)) before += length;
      if (ends_here(far, apart) || ends_here(far, close)) behind += length;
    }
  }
  return std::max(before, behind) / all;
}

namespace {

// All lines, and the two halves by where they begin, which may be the light of two windows.
std::vector<Bundle> with_halves(const Bundle& lines) {
  Vec3d low(INFINITY), high(-INFINITY), sum{};
  for (const uint32_t l : lines.which) {
    const Vec3d& begin = lines.line(l).light;
    low = min(low, begin), high = max(high, begin);
    sum += begin;
  }
  const Vec3d size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto before = [&](const LightLine& line) {
    return line.light[axis] * static_cast<double>(lines.size()) < sum[axis];
  };
  return {lines, lines.where(before), lines.where(std::not_fn(before))};
}

// A tube at the waist of a bundle, sought from where its light begins.
Tube at_waist(const LightGrid& grid, const Bundle& bundle, const Vec3d& along) {
  Vec3d sum{};
  for (const uint32_t l : bundle.which) sum += bundle.line(l).light;
  const Vec3d start = sum / static_cast<double>(bundle.size()) + along * (4 * grid.voxel);
  Tube tube;
  tube.middle = waist(bundle, {start, along});
  tube.half = 0.5 * grid.voxel;
  return tube;
}

}  // namespace

std::optional<Aperture> part_of_directions(const LightGrid& grid, const Bundle& lines,
                                           const Aperture& whole) {
  const Onb<double> frame(whole.tube.middle.n);
  const Extents e = extents_of(whole.polygon);
  const Vec3d longer = frame.x * e.axis.x + frame.y * e.axis.y;
  const Vec3d shorter = cross(whole.tube.middle.n, longer);
  // The cheap guess of a density may be too low by as much as the opening must be denser.
  const double promised = density_near(grid, whole.lines, whole.tube) / kDenser;
  double most = kDenser * density(whole);
  std::optional<Aperture> densest;
  for (const Vec3d& axis : {longer, -longer, shorter, -shorter}) {
    const Bundle along = whole.lines.where(
        [&](const LightLine& line) { return dot(line.camera - line.light, axis) > 0; });
    for (const Bundle& bundle : with_halves(along)) {
      if (bundle.size() < kFewestLines) continue;
      const Tube tube = find_waist(grid, bundle).value_or(at_waist(grid, bundle, axis));
      if (!(density_near(grid, bundle, tube) > promised)) continue;
      auto part = outlined(grid, bundle, tube);
      if (part) part = outlined(grid, lines, part->tube, true);
      if (!part || density(*part) < most) continue;
      most = density(*part);
      densest = std::move(part);
    }
  }
  return densest;
}

}  // namespace tdpt
