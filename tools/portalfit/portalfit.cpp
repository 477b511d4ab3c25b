// One aperture at a time: the fullest place, the lines around it, the plane of their waist, the
// hull of their crossings; then the lines it explains are deleted.
#include "tools/portalfit/portalfit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>

#include "tools/portalfit/bundle.h"
#include "tools/portalfit/paper.h"
#include "tools/portalfit/polygon.h"
#include "tools/portalfit/tube.h"

namespace tdpt {
namespace {

constexpr size_t kFewestLines = 30;
constexpr double kLeastExplained = 0.75;  // of a cut's lines, by all its portals
constexpr double kFewestProbes = 30;      // that tell the support
constexpr size_t kMostCorners = 12;
constexpr double kCornerTolerance = 0.003;  // of the area, for each corner saved
constexpr double kWithin = 0.85;            // of the tube's depth: where its outline is taken
constexpr double kFull = 0.5;               // of the fullest voxel, for the paper's rule
constexpr double kDegrees = 180 / std::numbers::pi;

struct Aperture {
  Tube tube;
  Polygon polygon;
  std::vector<uint32_t> lines;  // that cross it along the normal
};

// Cuts off parts of the hull that hold far fewer points than their area: light that comes around
// the edge of the aperture. Keeps in `points` what the hull keeps. Never takes more than the share
// kMostCut of the points.
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
      for (const Vec2d& p : points) reach.push_back(p.x * axis.x + p.y * axis.y);
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

std::vector<uint32_t> lines_across(const LightGrid& grid, const std::vector<uint32_t>& lines,
                                   const Aperture& a) {
  std::vector<uint32_t> across;
  for (const uint32_t l : lines)
    if (Vec2d at; inside_at(a.tube, grid.lines[l], 0, at) && contains(a.polygon, at))
      across.push_back(l);
  return across;
}

// Those that come through the opening or end within or close before it: none of them tells of
// another opening.
std::vector<uint32_t> lines_at(const LightGrid& grid, const std::vector<uint32_t>& lines,
                               const Aperture& a) {
  const Polygon wider = enlarged(a.polygon, 1.1);
  const Extents e = extents_of(a.polygon);
  Tube deeper = a.tube;
  deeper.half += 0.5 * e.shorter;
  std::vector<uint32_t> at_it;
  for (const uint32_t l : lines)
    for (const double offset : {0.0, -a.tube.half, a.tube.half, -deeper.half, deeper.half})
      if (Vec2d at; inside_at(deeper, grid.lines[l], offset, at) && contains(wider, at)) {
        at_it.push_back(l);
        break;
      }
  return at_it;
}

std::vector<LightLine> picked(const LightGrid& grid, const std::vector<uint32_t>& lines) {
  std::vector<LightLine> some;
  for (const uint32_t l : lines) some.push_back(grid.lines[l]);
  return some;
}

// The convex outline of an opening with these crossings, but for strays; empty when there is none.
Polygon outline_of(std::vector<Vec2d> points) {
  Polygon hull = convex_hull(points);
  if (hull.size() < 3 || !(area(hull) > 0)) return {};
  hull = trimmed(std::move(hull), points);
  // The hull of n random points lacks about (8/3) ln(n)/n of a quadrilateral's area.
  const auto n = static_cast<double>(points.size());
  return simplified(enlarged(hull, 1 + 8.0 / 3 * std::log(n) / n), kMostCorners, kCornerTolerance);
}

// The aperture among `lines` close to `tube`: its tube, its outline. `again`: it is one already.
std::optional<Aperture> outlined(const LightGrid& grid, const std::vector<uint32_t>& lines,
                                 const Tube& tube, bool again = false) {
  Aperture a{tube, {}, {}};
  std::vector<uint32_t> bundle;
  for (int round = 0; round < 3; ++round) {
    if (round > 0) a.tube = least_tube(picked(grid, bundle), a.tube, again || round > 1);
    bundle = members(grid, lines, a.tube, grid.voxel);
    if (bundle.size() < kFewestLines) return {};
  }

  std::vector<Vec2d> points;
  for (const uint32_t l : bundle)
    for (const double face : {-kWithin * a.tube.half, kWithin * a.tube.half})
      if (Vec2d at; inside_at(a.tube, grid.lines[l], face, at)) points.push_back(at);
  a.polygon = outline_of(std::move(points));
  if (a.polygon.empty()) return {};
  a.lines = lines_across(grid, lines, a);
  return a;
}

std::optional<Aperture> find_aperture(const LightGrid& grid, const std::vector<uint32_t>& lines) {
  Tube tube;
  Plane& plane = tube.middle;
  plane.o = fullest_place(grid, lines);
  plane.n = mean_direction_near(grid, lines, plane.o, 1.5 * grid.voxel);
  if (plane.n == Vec3d{}) return {};
  tube.half = 0.5 * grid.voxel;
  for (int round = 0; round < 6; ++round) {
    const Plane before = plane;
    const auto bundle = members(grid, lines, tube, grid.voxel);
    if (bundle.size() < kFewestLines) return {};
    plane = waist(grid, bundle, plane);
    if (dot(before.n, plane.n) > 1 - 1e-6 && length(before.o - plane.o) < 1e-3 * grid.voxel) break;
  }
  return outlined(grid, lines, tube);
}

// Share of the lines through the middle of the tube that pass both its faces.
double through_share(const Aperture& a) {
  const Extents e = extents_of(a.polygon);
  if (!(e.shorter > 0)) return 1;
  const double grow = std::sqrt(area(a.polygon) / (e.longer * e.shorter));
  return facing_rectangles(grow * e.longer, grow * e.shorter, 2 * a.tube.half);
}

// Share of the probes through the polygon that join the two sides, over that of a perfect opening
// as deep; nothing when the file does not know.
std::optional<double> support_of(const LightGrid& grid, const Aperture& a) {
  double tried = 0, joined = 0;
  for (const Probe& probe : grid.probes) {
    const LightLine back{probe.line.camera, probe.line.light, probe.line.cut};
    Vec2d at;
    if (!crossing(a.tube.middle, probe.line, at) &&
        (probe.joins || !crossing(a.tube.middle, back, at)))
      continue;
    if (!contains(a.polygon, at)) continue;
    ++tried;
    joined += probe.joins;
  }
  if (tried < kFewestProbes) return {};
  return std::min(1.0, joined / tried / through_share(a));
}

// Angles between n and the main and minor axis of the voxels fuller than half the fullest.
std::pair<double, double> pca_angles(const LightGrid& grid, const Vec3d& n) {
  const VoxelAxes axes = axes_of_full_voxels(grid, kFull);
  const auto angle = [&](const Vec3d& axis) {
    return kDegrees * std::acos(std::min(1.0, std::abs(dot(axis, n))));
  };
  return axes.centres.empty() ? std::pair{0.0, 0.0}
                              : std::pair{angle(axes.main), angle(axes.minor)};
}

// `of`: lines of the cut.
Portal portal_of(const LightGrid& grid, const Aperture& a, size_t of,
                 std::optional<double> support) {
  Portal portal;
  for (const Vec2d& p : a.polygon) portal.vertices.push_back(to_space(a.tube.middle, p));
  portal.triangles = triangulate(a.polygon);
  Vec3d sum{};
  for (const uint32_t l : a.lines) sum += normalize(grid.lines[l].camera - grid.lines[l].light);
  const Vec3d mean = normalize(sum);
  auto& f = portal.figures;
  f["area"] = area(a.polygon);
  f["flux_share"] = static_cast<double>(a.lines.size()) / static_cast<double>(of);
  if (support) f["support"] = *support;
  f["direction_x"] = mean.x;
  f["direction_y"] = mean.y;
  f["direction_z"] = mean.z;
  f["direction_angle"] = kDegrees * std::acos(std::clamp(dot(mean, a.tube.middle.n), -1.0, 1.0));
  f["concentration"] = length(sum) / static_cast<double>(a.lines.size());
  const auto [main, minor] = pca_angles(grid, a.tube.middle.n);
  f["pca_main_angle"] = main;
  f["pca_minor_angle"] = minor;
  return portal;
}

// Openings side by side, as the slit beside a door and the gap above it: light through the second
// crosses the plane of the first beyond its edge and draws its outline there. So each is outlined
// again by the lines that do not cross the others, at first with the others wider than found. Not
// where most of its lines cross others, too: such openings follow each other. All lines
// are those of `all`.
void part_from_each_other(const LightGrid& grid, const std::vector<uint32_t>& all,
                          std::vector<Aperture>& found) {
  if (found.size() < 2) return;
  constexpr double kShared = 0.01;  // of its lines: with fewer, an opening stays as it is
  for (const double growth : {1.5, 1.2, 1.0}) {
    for (Aperture& a : found) {
      std::vector<uint32_t> others;
      for (const Aperture& b : found) {
        if (&b == &a) continue;
        Aperture wider = b;
        wider.polygon = enlarged(b.polygon, growth);
        const auto across = lines_across(grid, all, wider);
        others.insert(others.end(), across.begin(), across.end());
      }
      std::sort(others.begin(), others.end());
      const auto without = [&](const std::vector<uint32_t>& lines) {
        std::vector<uint32_t> left;
        std::set_difference(lines.begin(), lines.end(), others.begin(), others.end(),
                            std::back_inserter(left));
        return left;
      };
      const auto shared = static_cast<double>(a.lines.size() - without(a.lines).size());
      const auto size = static_cast<double>(a.lines.size());
      if (shared < kShared * size || shared > 0.5 * size) continue;
      auto again = outlined(grid, without(all), a.tube, true);
      if (!again) continue;
      again->lines = lines_across(grid, all, *again);
      if (2 * again->lines.size() >= a.lines.size()) a = std::move(*again);
    }
  }
}

// Lines between openings that share an edge belong to neither yet: an opening takes those beside
// its outline that no other has.
void take_lines_between(const LightGrid& grid, const std::vector<uint32_t>& all,
                        std::vector<Aperture>& found) {
  if (found.size() < 2) return;
  constexpr double kReach = 1.5;  // in area
  for (Aperture& a : found) {
    std::vector<uint32_t> taken;
    for (const Aperture& b : found)
      if (&b != &a) taken.insert(taken.end(), b.lines.begin(), b.lines.end());
    std::sort(taken.begin(), taken.end());
    const Polygon reach = enlarged(a.polygon, kReach);
    std::vector<Vec2d> points;
    size_t more = 0;
    for (const uint32_t l : all) {
      Vec2d at;
      if (!crossing(a.tube.middle, grid.lines[l], at) || !contains(reach, at)) continue;
      const bool own = contains(a.polygon, at);
      if (!own && std::binary_search(taken.begin(), taken.end(), l)) continue;
      points.push_back(at);
      more += !own;
    }
    if (more == 0) continue;
    Polygon wider = outline_of(std::move(points));
    if (area(wider) <= area(a.polygon)) continue;
    a.polygon = std::move(wider);
    a.lines = lines_across(grid, all, a);
  }
}

// The openings that the lines `all` of one cut pass. `scattered`: most pass elsewhere.
std::vector<Aperture> fit_cut(const LightGrid& grid, const std::vector<uint32_t>& all,
                              const PortalFitOptions& options, std::vector<std::string>& refused,
                              bool& scattered) {
  const auto total = static_cast<double>(all.size());
  std::vector<uint32_t> rest = all;
  std::vector<Aperture> found;
  // A refused candidate costs its lines, so this ends.
  for (size_t refusals = 0; static_cast<double>(rest.size()) >= options.threshold * total &&
                            rest.size() >= kFewestLines && found.size() < options.max_portals &&
                            refusals < options.max_portals;) {
    const auto aperture = find_aperture(grid, rest);
    if (!aperture || aperture->lines.empty()) {
      refused.push_back("the lines left have no common waist");
      break;
    }
    const double share = static_cast<double>(aperture->lines.size()) / total;
    const auto support = support_of(grid, *aperture);
    ++refusals;
    if (share < options.threshold) {
      refused.push_back(fmt::format("a candidate carries {:.1f} % of the lines only", 100 * share));
    } else if (support && *support < options.support) {
      refused.push_back(fmt::format(
          "a candidate lies within one side: only {:.0f} % of the lines through it join the two",
          100 * *support));
    } else {
      --refusals;
      found.push_back(*aperture);
    }
    std::vector<uint32_t> left;
    const std::vector<uint32_t> gone = lines_at(grid, rest, *aperture);
    std::set_difference(rest.begin(), rest.end(), gone.begin(), gone.end(),
                        std::back_inserter(left));
    rest = std::move(left);
  }
  part_from_each_other(grid, all, found);
  take_lines_between(grid, all, found);
  std::set<uint32_t> through;
  for (const Aperture& a : found) through.insert(a.lines.begin(), a.lines.end());
  // Not where openings were left out on request.
  scattered = found.size() < options.max_portals &&
              options.threshold <= PortalFitOptions{}.threshold &&
              static_cast<double>(through.size()) < kLeastExplained * total;
  return found;
}

// Whether one opening is the other again, found by the light of another cut.
bool same_opening(const LightGrid& grid, const Aperture& a, const Aperture& b) {
  const double size = std::sqrt(std::min(area(a.polygon), area(b.polygon)));
  const auto middle = [](const Aperture& x) {
    Vec3d sum{};
    for (const Vec2d& p : x.polygon) sum += to_space(x.tube.middle, p);
    return sum / static_cast<double>(x.polygon.size());
  };
  constexpr double kNear = 0.9;  // cosine
  return dot(a.tube.middle.n, b.tube.middle.n) > kNear &&
         length(middle(a) - middle(b)) < std::max(0.3 * size, grid.voxel);
}

}  // namespace

FitResult fit_portals(const LightGrid& grid, const PortalFitOptions& options) {
  FitResult result;
  if (!grid.bottleneck || grid.lines.empty()) return result;
  if (options.by_paper) {
    if (const auto portal = portal_by_paper(grid, kFull)) result.portals.push_back(*portal);
    return result;
  }
  std::vector<std::vector<uint32_t>> of_cut;
  for (uint32_t l = 0; l < grid.lines.size(); ++l) {
    const uint32_t c = grid.lines[l].cut;
    if (c >= of_cut.size()) of_cut.resize(c + 1);
    of_cut[c].push_back(l);
  }
  std::vector<Aperture> found;
  size_t explained = 0;
  for (size_t c = 0; c < of_cut.size(); ++c) {
    const std::vector<uint32_t>& lines = of_cut[c];
    bool scattered = false;
    const std::vector<Aperture> of_this = fit_cut(grid, lines, options, result.refused, scattered);
    std::vector<uint32_t> crossed;
    for (const Aperture& a : of_this) crossed.insert(crossed.end(), a.lines.begin(), a.lines.end());
    std::sort(crossed.begin(), crossed.end());
    crossed.erase(std::unique(crossed.begin(), crossed.end()), crossed.end());
    const double share = static_cast<double>(crossed.size()) /
                         static_cast<double>(std::max<size_t>(lines.size(), 1));
    if (!of_this.empty() && scattered) {
      result.refused.push_back(
          fmt::format("the light passes cut {} in too many places: {} of them carry {:.0f} % of it",
                      c + 1, of_this.size(), 100 * share));
      continue;
    }
    explained += crossed.size();
    for (const Aperture& a : of_this) {
      if (found.size() >= options.max_portals ||
          std::any_of(found.begin(), found.end(),
                      [&](const Aperture& b) { return same_opening(grid, a, b); }))
        continue;
      found.push_back(a);
      result.portals.push_back(portal_of(grid, a, lines.size(), support_of(grid, a)));
    }
  }
  result.explained = static_cast<double>(explained) / static_cast<double>(grid.lines.size());
  return result;
}

}  // namespace tdpt
