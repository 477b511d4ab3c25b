// What tells an opening from a plane in the air.
//
// Method: of a part of a plane across several openings, fewer lines pass to the area than of an
// opening itself (minimum etendue again); so among the lines through a half and a third of it an
// aperture is looked for that is denser.
#include "tools/portalfit/candidate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/portalfit/bundle.h"
#include "tools/portalfit/merit.h"
#include "tools/portalfit/moments.h"
#include "tools/portalfit/portal_shape.h"

namespace tdpt {
namespace {

constexpr double kFewestProbes = 30;   // that tell the support
constexpr double kSure = 0.8;          // support: with less it may be several openings
constexpr double kDenser = 1.3;        // lines to the area, of a part over the whole
constexpr double kLeastOfWhole = 0.1;  // of its lines, in such a part
constexpr double kTowards = 0.6;       // cosine: lines of one wall's windows

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

// Those of its lines that cross `a` along `axis` between these places, the middle being 0.
std::vector<uint32_t> strip_of(const LightGrid& grid, const Aperture& a, Vec2d middle, Vec2d axis,
                               double from, double to) {
  std::vector<uint32_t> strip;
  for (const uint32_t l : a.lines)
    if (const auto at = crossing(a.tube.middle, grid.lines[l])) {
      const double along = dot(*at - middle, axis);
      if (along >= from && along < to) strip.push_back(l);
    }
  return strip;
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
  if (tried < kFewestProbes) return {};
  return std::min(1.0, joined / tried / through_share(a));
}

double fullness_of(const LightGrid& grid, const Aperture& a) {
  Portal portal;
  for (const Vec2d& p : a.polygon) portal.vertices.push_back(to_space(a.tube.middle, p));
  portal.triangles = triangulate(a.polygon);
  const PortalShape shape = shape_of(portal);
  std::vector<Crossing> crossings;
  for (const uint32_t l : a.lines)
    if (const auto at = crossing(shape.plane, grid.lines[l]); at && contains(shape, *at))
      crossings.push_back({l, *at});
  return std::min(1.0, tightness_of(grid, shape, crossings).value_or(0) / through_share(a));
}

double density_of(const Aperture& a) {
  return static_cast<double>(a.lines.size()) / (area(a.polygon) * through_share(a));
}

namespace {

// All of them, and those that begin on either side of the middle of where they do: light of two
// windows.
std::vector<std::vector<uint32_t>> apart(const LightGrid& grid,
                                         const std::vector<uint32_t>& lines) {
  Vec3d low(INFINITY), high(-INFINITY), sum{};
  for (const uint32_t l : lines) {
    low = min(low, grid.lines[l].light), high = max(high, grid.lines[l].light);
    sum += grid.lines[l].light;
  }
  const Vec3d size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::vector<std::vector<uint32_t>> sets{lines, {}, {}};
  for (const uint32_t l : lines)
    sets[grid.lines[l].light[axis] * static_cast<double>(lines.size()) < sum[axis] ? 1 : 2]
        .push_back(l);
  return sets;
}

// At the narrowest place of a bundle, looked for from where its light begins.
Tube at_waist(const LightGrid& grid, const std::vector<uint32_t>& bundle, const Vec3d& along) {
  Vec3d sum{};
  for (const uint32_t l : bundle) sum += grid.lines[l].light;
  const Vec3d start = sum / static_cast<double>(bundle.size()) + along * (4 * grid.voxel);
  Tube tube;
  tube.middle = waist(grid, bundle, {start, along});
  tube.half = 0.5 * grid.voxel;
  return tube;
}

// The densest opening, among all `lines`, of those of `some` that go along one of the `axes`, as
// far as it is denser than `most` and holds so many.
std::optional<Aperture> densest_along(const LightGrid& grid, const std::vector<uint32_t>& lines,
                                      const std::vector<uint32_t>& some,
                                      const std::vector<Vec3d>& axes, double least_cos, double most,
                                      double fewest) {
  std::optional<Aperture> best;
  for (const Vec3d& axis : axes) {
    std::vector<uint32_t> along;
    for (const uint32_t l : some)
      if (dot(normalize(grid.lines[l].camera - grid.lines[l].light), axis) > least_cos)
        along.push_back(l);
    for (const std::vector<uint32_t>& bundle : apart(grid, along)) {
      if (bundle.size() < kFewestLines) continue;
      auto part = find_aperture(grid, bundle);
      if (!part) part = outlined(grid, bundle, at_waist(grid, bundle, axis));
      if (part) part = outlined(grid, lines, part->tube, true);
      if (!part || density(*part) < most || static_cast<double>(part->lines.size()) < fewest)
        continue;
      most = density(*part);
      best = std::move(part);
    }
  }
  return best;
}

}  // namespace

std::optional<Aperture> part_of_directions(const LightGrid& grid,
                                           const std::vector<uint32_t>& lines,
                                           const Aperture& whole) {
  const Onb<double> frame(whole.tube.middle.n);
  const Extents e = extents_of(whole.polygon);
  const Vec3d longer = frame.x * e.axis.x + frame.y * e.axis.y;
  const Vec3d shorter = cross(whole.tube.middle.n, longer);
  return densest_along(grid, lines, whole.lines, {longer, -longer, shorter, -shorter}, 0,
                       kDenser * density(whole),
                       kLeastOfWhole * static_cast<double>(whole.lines.size()));
}

std::optional<Aperture> aperture_of_directions(const LightGrid& grid,
                                               const std::vector<uint32_t>& lines) {
  Vec3d sum{};
  for (const uint32_t l : lines) sum += normalize(grid.lines[l].camera - grid.lines[l].light);
  if (!(length(sum) > 0)) return {};
  std::vector<Vec3d> axes{normalize(sum)};
  for (const Vec3d& axis : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}})
    axes.insert(axes.end(), {axis, -axis});
  return densest_along(grid, lines, lines, axes, kTowards, 0,
                       kLeastOfWhole * static_cast<double>(lines.size()));
}

std::optional<Aperture> denser_part(const LightGrid& grid, const std::vector<uint32_t>& lines,
                                    const Aperture& whole) {
  const auto support = support_of(grid, whole);
  if (!support || *support >= kSure) return {};
  const Extents e = extents_of(whole.polygon);
  std::optional<Aperture> best;
  double most = kDenser * density(whole);
  const double third = e.longer / 3, far = 2 * e.longer;
  for (const auto& [from, to] : {std::pair{-far, 0.0},
                                 {0.0, far},
                                 {-far, -0.5 * third},
                                 {-0.5 * third, 0.5 * third},
                                 {0.5 * third, far}}) {
    const auto strip = strip_of(grid, whole, e.mean, e.axis, from, to);
    auto part = find_aperture(grid, strip);
    if (part) part = outlined(grid, lines, part->tube, true);
    if (!part || density(*part) < most ||
        static_cast<double>(part->lines.size()) <
            kLeastOfWhole * static_cast<double>(whole.lines.size()))
      continue;
    if (support_of(grid, *part).value_or(0) < *support) continue;
    most = density(*part);
    best = std::move(part);
  }
  return best;
}

}  // namespace tdpt
