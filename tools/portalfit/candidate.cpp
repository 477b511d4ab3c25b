// Distinguishes an opening from a plane in the air.
//
// Method: a plane across several openings has fewer lines per area than a single opening (minimum
// etendue again); so a denser aperture is sought among the lines through a half and a third of it.
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

constexpr double kFewestProbes = 30;   // to estimate the support
constexpr double kSure = 0.8;          // support below which it may be several openings
constexpr double kDenser = 1.3;        // lines per area, of a part over the whole
constexpr double kLeastOfWhole = 0.1;  // share of its lines in such a part
constexpr double kBeyond = 0.15;       // of an opening's size: how much farther a room reaches
constexpr double kFewestVoxels = 4;    // across an opening whose surroundings the grid resolves
constexpr int kPlaces = 16;            // along each side of an outline
constexpr size_t kMostFitted = 2;      // of the places that promise a denser part

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

// Its lines that cross `a` between these positions along `axis`, measured from `middle`.
Bundle strip_of(const Aperture& a, Vec2d middle, Vec2d axis, double from, double to) {
  return a.lines.where([&](const LightLine& line) {
    const auto at = crossing(a.tube.middle, line);
    if (!at) return false;
    const double along = dot(*at - middle, axis);
    return along >= from && along < to;
  });
}

}  // namespace

std::optional<double> support_of(const std::vector<Probe>& probes, const Aperture& a) {
  double tried = 0, joined = 0;
  for (const Probe& probe : probes) {
    const LightLine back{probe.line.camera, probe.line.light, probe.line.cut};
    auto at = clear_crossing(a.tube.middle, probe.line);
    if (!at && !probe.joins) at = clear_crossing(a.tube.middle, back);
    if (!at || !contains(a.polygon, *at)) continue;
    ++tried;
    joined += probe.joins;
  }
  if (tried < kFewestProbes) return {};
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
  if (grid.air.empty() || size < kFewestVoxels * grid.voxel) return {};
  const double beyond = std::max(2 * grid.voxel, kBeyond * size), far = a.tube.half + 0.5 * size;
  const Vec2d middle = extents_of(a.polygon).mean;
  double before = 0, behind = 0, all = 0;
  for (size_t i = 0; i < a.polygon.size(); ++i) {
    const Vec2d from = a.polygon[i], side = a.polygon[(i + 1) % a.polygon.size()] - from;
    const double length = std::sqrt(dot(side, side));
    if (!(length > 0)) continue;
    const Vec2d out = Vec2d{side.y, -side.x} * (beyond / length);
    for (int k = 0; k < kPlaces; ++k) {
      const Vec2d edge = from + side * ((k + 0.5) / kPlaces);
      all += length;
      if (sees_past(grid, a, middle, edge, out, 0)) continue;
      if (sees_past(grid, a, middle, edge, out, -far)) before += length;
      if (sees_past(grid, a, middle, edge, out, far)) behind += length;
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
Tube at_waist(const Bundle& bundle, const Vec3d& along, double voxel) {
  Vec3d sum{};
  for (const uint32_t l : bundle.which) sum += bundle.line(l).light;
  const Vec3d start = sum / static_cast<double>(bundle.size()) + along * (4 * voxel);
  Tube tube;
  tube.middle = waist(bundle, {start, along});
  tube.half = 0.5 * voxel;
  return tube;
}

// A place for an opening of a bundle, with the density that it promises.
struct Promise {
  Bundle bundle;
  Tube tube;
  double density = 0;
};

// The densest opening, among all `lines`, where one of the `promises` has it, if it is denser than
// `most` and has at least `fewest` lines. Only the few that promise most, and more than `promised`,
// are fitted.
std::optional<Aperture> densest_of(const LightGrid& grid, const Bundle& lines,
                                   std::vector<Promise> promises, double promised, double most,
                                   double fewest) {
  std::erase_if(promises, [&](const Promise& p) { return !(p.density > 0.8 * promised); });
  std::stable_sort(promises.begin(), promises.end(),
                   [](const Promise& a, const Promise& b) { return a.density > b.density; });
  if (promises.size() > kMostFitted) promises.resize(kMostFitted);
  std::optional<Aperture> best;
  for (const Promise& p : promises) {
    auto part = outlined(grid, p.bundle, p.tube);
    if (part) part = outlined(grid, lines, part->tube, true);
    if (!part || density(*part) < most || static_cast<double>(part->lines.size()) < fewest)
      continue;
    most = density(*part);
    best = std::move(part);
  }
  return best;
}

}  // namespace

std::optional<Aperture> part_of_directions(const LightGrid& grid, const Bundle& lines,
                                           const Aperture& whole) {
  const Onb<double> frame(whole.tube.middle.n);
  const Extents e = extents_of(whole.polygon);
  const Vec3d longer = frame.x * e.axis.x + frame.y * e.axis.y;
  const Vec3d shorter = cross(whole.tube.middle.n, longer);
  std::vector<Promise> promises;
  for (const Vec3d& axis : {longer, -longer, shorter, -shorter}) {
    const Bundle along = whole.lines.where(
        [&](const LightLine& line) { return dot(line.camera - line.light, axis) > 0; });
    for (const Bundle& bundle : apart(along)) {
      if (bundle.size() < kFewestLines) continue;
      const Tube tube = find_waist(grid, bundle).value_or(at_waist(bundle, axis, grid.voxel));
      promises.push_back({bundle, tube, density_near(bundle, tube, grid.voxel)});
    }
  }
  return densest_of(grid, lines, std::move(promises),
                    density_near(whole.lines, whole.tube, grid.voxel), kDenser * density(whole),
                    kLeastOfWhole * static_cast<double>(whole.lines.size()));
}

std::optional<Aperture> denser_part(const LightGrid& grid, const Bundle& lines,
                                    const Aperture& whole) {
  const auto support = support_of(grid.probes, whole);
  if (!support || *support >= kSure) return {};
  const Extents e = extents_of(whole.polygon);
  const double third = e.longer / 3, far = 2 * e.longer;
  std::vector<Promise> promises;
  for (const auto& [from, to] : {std::pair{-far, 0.0},
                                 {0.0, far},
                                 {-far, -0.5 * third},
                                 {-0.5 * third, 0.5 * third},
                                 {0.5 * third, far}}) {
    const Bundle strip = strip_of(whole, e.mean, e.axis, from, to);
    if (const auto tube = find_waist(grid, strip))
      promises.push_back({strip, *tube, density_near(strip, *tube, grid.voxel)});
  }
  auto part = densest_of(
      grid, lines, std::move(promises), density_near(whole.lines, whole.tube, grid.voxel),
      kDenser * density(whole), kLeastOfWhole * static_cast<double>(whole.lines.size()));
  if (part && support_of(grid.probes, *part).value_or(0) < *support) return {};
  return part;
}

}  // namespace tdpt
