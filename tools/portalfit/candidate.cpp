// Distinguishes an opening from a plane in the air.
//
// Method: a plane across two windows at a corner has fewer lines per area than either of them
// (minimum etendue again); so a denser aperture is sought among its lines to one side.
#include "tools/portalfit/candidate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "tools/portalfit/bundle.h"
#include "tools/portalfit/merit.h"
#include "tools/portalfit/moments.h"
#include "tools/portalfit/portal_shape.h"

namespace tdpt {
namespace {

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

std::optional<double> support_of(const FitInput& in, const Aperture& a) {
  double tried = 0, joined = 0;
  for (const Probe& probe : in.grid.probes) {
    const LightLine back{probe.line.camera, probe.line.light, probe.line.cut};
    auto at = clear_crossing(a.tube.middle, probe.line, in.limits);
    if (!at && !probe.joins) at = clear_crossing(a.tube.middle, back, in.limits);
    if (!at || !contains(a.polygon, *at)) continue;
    ++tried;
    joined += probe.joins;
  }
  if (tried < in.limits.fewest) return {};
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

std::optional<double> edge_share(const FitInput& in, const Aperture& a) {
  const LightGrid& grid = in.grid;
  const double size = std::sqrt(area(a.polygon));
  const bool no_walls = std::find(grid.air.begin(), grid.air.end(), 0) == grid.air.end();
  if (no_walls || size < 2 * in.limits.resolved * grid.voxel) return {};
  // How far past the outline is looked: a wall may stand apart from it, or reach little beyond it.
  const double apart = std::max(in.limits.resolved * grid.voxel, in.limits.beside * size),
               close = std::min(apart, 2 * in.limits.resolved * grid.voxel),
               far = a.tube.half + 0.5 * size;
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
std::vector<Bundle> apart(const Bundle& lines) {
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
Tube at_waist(const FitInput& in, const Bundle& bundle, const Vec3d& along) {
  Vec3d sum{};
  for (const uint32_t l : bundle.which) sum += bundle.line(l).light;
  const Vec3d start = sum / static_cast<double>(bundle.size()) + along * (4 * in.grid.voxel);
  Tube tube;
  tube.middle = waist(bundle, {start, along}, in.limits);
  tube.half = 0.5 * in.grid.voxel;
  return tube;
}

}  // namespace

std::optional<Aperture> part_of_directions(const FitInput& in, const Bundle& lines,
                                           const Aperture& whole) {
  const Onb<double> frame(whole.tube.middle.n);
  const Extents e = extents_of(whole.polygon);
  const Vec3d longer = frame.x * e.axis.x + frame.y * e.axis.y;
  const Vec3d shorter = cross(whole.tube.middle.n, longer);
  // The cheap guess of a density may be too low by as much as the opening must be denser.
  const double promised = density_near(in, whole.lines, whole.tube) / in.limits.denser;
  double most = in.limits.denser * density(whole);
  std::optional<Aperture> densest;
  for (const Vec3d& axis : {longer, -longer, shorter, -shorter}) {
    const Bundle along = whole.lines.where(
        [&](const LightLine& line) { return dot(line.camera - line.light, axis) > 0; });
    for (const Bundle& bundle : apart(along)) {
      if (in.limits.few(bundle.size())) continue;
      const Tube tube = find_waist(in, bundle).value_or(at_waist(in, bundle, axis));
      if (!(density_near(in, bundle, tube) > promised)) continue;
      auto part = outlined(in, bundle, tube);
      if (part) part = outlined(in, lines, part->tube, true);
      if (!part || density(*part) < most) continue;
      most = density(*part);
      densest = std::move(part);
    }
  }
  return densest;
}

}  // namespace tdpt
