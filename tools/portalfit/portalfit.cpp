// Finds the planar openings that the light of a grid passes, cut by cut.
//
// Method: greedy (sequential) fitting, as sequential RANSAC finds planes: one aperture at a time,
// whose lines are deleted, until few are left. A candidate needs support (few of the probes through
// it may join one side with itself) and edges (lines must fill it). Openings beside each other in
// one plane are joined, as panes; then each needs a share of the lines; then those that stand
// beside each other are separated.
#include "tools/portalfit/portalfit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "libcommon/base/number_words.h"
#include "tools/portalfit/aperture.h"
#include "tools/portalfit/candidate.h"
#include "tools/portalfit/joining.h"
#include "tools/portalfit/moments.h"
#include "tools/portalfit/paper.h"
#include "tools/portalfit/parting.h"
#include "tools/portalfit/polygon.h"
#include "tools/portalfit/tube.h"

namespace tdpt {
namespace {

constexpr double kLeastPart = 0.25;     // of the threshold, before parts are joined
constexpr double kStrays = 0.15;        // share of the lines that may be leaks
constexpr double kAfterAll = 2.5;       // times the threshold, after nearly all light is explained
constexpr double kSparse = 0.2;         // of the density of other openings of the cut
constexpr double kLeastPassing = 0.25;  // of a candidate's lines: support times fullness
constexpr size_t kMostTried = 48;       // candidates per cut
// Least support of a single opening: a plane across a corner with windows on both sides has less.
constexpr double kOneOpening = 0.9;
constexpr double kFull = 0.5;  // of the fullest voxel, for the paper's rule
constexpr double kDegrees = 180 / std::numbers::pi;

using Refusals = std::vector<FitResult::Refusal>;

// Removes lines that come through the opening, or end within or close before it: they tell nothing
// of other openings.
Bundle lines_not_at(const Bundle& lines, const Aperture& a) {
  const Polygon wider = enlarged(a.polygon, 1.1);
  const Extents e = extents_of(a.polygon);
  Tube deeper = a.tube;
  deeper.half += 0.5 * e.shorter;
  return lines.where([&](const LightLine& line) {
    for (const double offset : {0.0, -a.tube.half, a.tube.half, -deeper.half, deeper.half})
      if (const auto at = inside_at(deeper, line, offset); at && contains(wider, *at)) return false;
    return true;
  });
}

// Angles between n and the main and minor axis of the voxels with over half the fullest one's
// count.
std::pair<double, double> pca_angles(const LightGrid& grid, const Vec3d& n) {
  const VoxelAxes axes = axes_of_full_voxels(grid, kFull);
  const auto angle = [&](const Vec3d& axis) {
    return kDegrees * std::acos(std::min(1.0, std::abs(dot(axis, n))));
  };
  return axes.centres.empty() ? std::pair{0.0, 0.0}
                              : std::pair{angle(axes.main), angle(axes.minor)};
}

// `of`: number of lines of the cut.
Portal portal_of(const LightGrid& grid, const Aperture& a, size_t of,
                 std::optional<double> support) {
  Portal portal;
  for (const Vec2d& p : a.polygon) portal.vertices.push_back(to_space(a.tube.middle, p));
  portal.triangles = triangulate(a.polygon);
  Vec3d sum{};
  for (const LightLine& line : a.lines.lines()) sum += normalize(line.camera - line.light);
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

std::string at_least(double share) {
  return fmt::format("at least {}", percent_words(share));
}

double share_of(const Aperture& a, size_t lines) {
  return static_cast<double>(a.lines.size()) / static_cast<double>(lines);
}

// Openings that the lines `all` of one cut pass, one by one, however little each carries.
std::vector<Aperture> parts_of(const LightGrid& grid, const Bundle& all,
                               const PortalFitOptions& options, FitResult& result) {
  Refusals& refused = result.refused;
  const double fewest = std::max(static_cast<double>(kFewestLines),
                                 kLeastPart * options.threshold * static_cast<double>(all.size()));
  Bundle rest = all;
  std::vector<Aperture> parts;
  // Ends, since each candidate removes its lines.
  for (size_t tried = 0; tried < kMostTried && static_cast<double>(rest.size()) >= fewest;
       ++tried) {
    auto aperture = find_aperture(grid, rest);
    if ((!aperture || aperture->lines.empty()) &&
        static_cast<double>(rest.size()) > kStrays * static_cast<double>(all.size()))
      aperture = aperture_of_directions(grid, rest);
    if (!aperture || aperture->lines.empty()) {
      refused.push_back({"the lines left have no common waist", ""});
      break;
    }
    ++result.candidates;
    if (auto part = denser_part(grid, rest, *aperture)) aperture = std::move(part);
    auto support = support_of(grid.probes, *aperture);
    double passing = support.value_or(1) * fullness_of(*aperture);
    // Lines that end before an opening found earlier may belong to this one, and a plane before two
    // windows at a corner has a denser part.
    const auto instead = [&](std::optional<Aperture> other) {
      if (!other || other->lines.empty()) return;
      aperture = std::move(other);
      support = support_of(grid.probes, *aperture);
      passing = support.value_or(1) * fullness_of(*aperture);
    };
    if (passing < kLeastPassing && !parts.empty())
      instead(find_aperture(grid, lines_beside(all, parts)));
    if (passing < kLeastPassing || support.value_or(1) < kOneOpening)
      instead(part_of_directions(grid, rest, *aperture));
    if (support && *support < options.support)
      refused.push_back(
          {fmt::format(
               "a candidate lies within one side: only {:.0f} % of the lines through it join the "
               "two",
               100 * *support),
           at_least(options.support)});
    else if (passing < kLeastPassing)
      refused.push_back({fmt::format("a candidate of {} m2 lies in the open: only {:.0f} % of "
                                     "the lines through it pass from one side to the other",
                                     number_words(area(aperture->polygon), 2), 100 * passing),
                         at_least(kLeastPassing)});
    else if (static_cast<double>(aperture->lines.size()) >= fewest)
      parts.push_back(*aperture);
    Bundle left = lines_not_at(rest, *aperture);
    if (left.size() == rest.size()) break;
    rest = std::move(left);
  }
  return parts;
}

// Removes openings with far fewer lines per etendue than others of about as many lines: they are
// leaks, spread over a large plane.
void leave_out_sparse(std::vector<Aperture>& found, Refusals& refused) {
  std::vector<Aperture> left;
  for (const Aperture& a : found) {
    // The depth of small openings is uncertain: that of the other is taken as 0.
    const double least = density_of(a) / kSparse;
    if (std::none_of(found.begin(), found.end(), [&](const Aperture& b) {
          return 2 * b.lines.size() >= a.lines.size() &&
                 static_cast<double>(b.lines.size()) > least * area(b.polygon);
        }))
      left.push_back(a);
    else
      refused.push_back(
          {fmt::format("a candidate of {} m2 lies in the open: others pass as many lines in a "
                       "fifth of its area",
                       number_words(area(a.polygon), 2)),
           ""});
  }
  found = std::move(left);
}

// Keeps the openings that carry enough light, the fullest first. Once nearly all is explained the
// rest may be leaks, and the threshold is higher.
std::vector<Aperture> enough_light(std::vector<Aperture> found, size_t lines,
                                   const PortalFitOptions& options, Refusals& refused) {
  std::stable_sort(found.begin(), found.end(), [](const Aperture& a, const Aperture& b) {
    return a.lines.size() > b.lines.size();
  });
  std::vector<Aperture> enough;
  double carried = 0, too_little = 0;
  size_t few = 0;
  for (Aperture& a : found) {
    const double share = share_of(a, lines);
    if (share < options.threshold * (carried > 1 - kStrays ? kAfterAll : 1))
      ++few, too_little += share;
    else
      carried += share, enough.push_back(std::move(a));
  }
  if (few > 0)
    refused.push_back({fmt::format("{} {} {:.1f} % of the lines only", few,
                                   few == 1 ? "candidate carries" : "candidates together carry",
                                   100 * too_little),
                       at_least(options.threshold * (carried > 1 - kStrays ? kAfterAll : 1))});
  return enough;
}

// The openings of one cut with the lines `all`, the fullest first.
std::vector<Aperture> fit_cut(const LightGrid& grid, const Bundle& all,
                              const PortalFitOptions& options, FitResult& result) {
  Refusals& refused = result.refused;
  std::vector<Aperture> found = joined_in_planes(all, parts_of(grid, all, options, result),
                                                 std::numeric_limits<size_t>::max(), grid.voxel);
  leave_out_sparse(found, refused);
  found = enough_light(std::move(found), all.size(), options, refused);
  if (found.size() > options.max_portals) {
    found = joined_in_planes(all, std::move(found), options.max_portals, grid.voxel);
    found = enough_light(std::move(found), all.size(), options, refused);
  }
  if (found.size() > options.max_portals) {
    refused.push_back({fmt::format("{} openings more than {}", found.size() - options.max_portals,
                                   options.max_portals),
                       "--max-portals"});
    found.resize(options.max_portals);
  }
  part_from_each_other(all, found, grid.voxel);
  part_at_shared_edges(all, found);
  return found;
}

// Whether both are the same opening, found by the light of two cuts.
bool same_opening(const Aperture& a, const Aperture& b, double voxel) {
  const double size = std::sqrt(std::min(area(a.polygon), area(b.polygon)));
  const auto middle = [](const Aperture& x) {
    Vec3d sum{};
    for (const Vec2d& p : x.polygon) sum += to_space(x.tube.middle, p);
    return sum / static_cast<double>(x.polygon.size());
  };
  constexpr double kNear = 0.9;  // cosine
  return dot(a.tube.middle.n, b.tube.middle.n) > kNear &&
         length(middle(a) - middle(b)) < std::max(0.3 * size, voxel);
}

}  // namespace

FitResult fit_portals(const LightGrid& grid, const PortalFitOptions& options) {
  FitResult result;
  if (!grid.bottleneck || grid.lines.empty()) return result;
  if (options.by_paper) {
    result.candidates = 1;
    if (auto found = portal_by_paper(grid, kFull)) {
      result.portals.push_back(std::move(found->portal));
      result.explained =
          static_cast<double>(found->lines.size()) / static_cast<double>(grid.lines.size());
      result.lines.push_back(std::move(found->lines));
    }
    return result;
  }
  std::vector<Bundle> of_cut;
  for (uint32_t l = 0; l < grid.lines.size(); ++l) {
    const uint32_t c = grid.lines[l].cut;
    if (c >= of_cut.size()) of_cut.resize(c + 1, {&grid.lines});
    of_cut[c].which.push_back(l);
  }
  std::vector<Aperture> found;
  size_t explained = 0;
  for (const Bundle& lines : of_cut) {
    const std::vector<Aperture> of_this = fit_cut(grid, lines, options, result);
    std::set<uint32_t> crossed;
    for (const Aperture& a : of_this) crossed.insert(a.lines.which.begin(), a.lines.which.end());
    explained += crossed.size();
    for (const Aperture& a : of_this) {
      if (found.size() >= options.max_portals ||
          std::any_of(found.begin(), found.end(),
                      [&](const Aperture& b) { return same_opening(a, b, grid.voxel); })) {
        ++result.repeated;
        continue;
      }
      found.push_back(a);
      result.portals.push_back(portal_of(grid, a, lines.size(), support_of(grid.probes, a)));
      result.lines.push_back(a.lines.which);
    }
  }
  result.explained = static_cast<double>(explained) / static_cast<double>(grid.lines.size());
  return result;
}

}  // namespace tdpt
