// The planar openings that the light of a grid passes, cut by cut.
//
// Method: greedy (sequential) fitting, as sequential RANSAC finds planes: one aperture at a time,
// the lines it explains are deleted, until few are left; then those that stand beside each other
// are parted. A candidate needs a share of the lines, and support: few of the probes through it may
// join one side with itself.
#include "tools/portalfit/portalfit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "tools/portalfit/aperture.h"
#include "tools/portalfit/moments.h"
#include "tools/portalfit/paper.h"
#include "tools/portalfit/parting.h"
#include "tools/portalfit/polygon.h"
#include "tools/portalfit/tube.h"

namespace tdpt {
namespace {

constexpr double kLeastExplained = 0.75;  // of a cut's lines, by all its portals
constexpr double kFewestProbes = 30;      // that tell the support
constexpr double kFull = 0.5;             // of the fullest voxel, for the paper's rule
constexpr double kDegrees = 180 / std::numbers::pi;

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
      if (const auto at = inside_at(deeper, grid.lines[l], offset); at && contains(wider, *at)) {
        at_it.push_back(l);
        break;
      }
  return at_it;
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
    auto at = clear_crossing(a.tube.middle, probe.line);
    if (!at && !probe.joins) at = clear_crossing(a.tube.middle, back);
    if (!at || !contains(a.polygon, *at)) continue;
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
  part_at_shared_edges(grid, all, found);
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
    if (auto found = portal_by_paper(grid, kFull)) {
      result.portals.push_back(std::move(found->portal));
      result.lines.push_back(std::move(found->lines));
    }
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
      result.lines.push_back(a.lines);
    }
  }
  result.explained = static_cast<double>(explained) / static_cast<double>(grid.lines.size());
  return result;
}

}  // namespace tdpt
