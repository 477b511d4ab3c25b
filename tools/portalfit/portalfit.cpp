// Finds the planar openings that the light of a grid passes, cut by cut.
//
// Method: greedy (sequential) fitting, as sequential RANSAC finds planes: one aperture at a time,
// whose lines are deleted, until few are left. A candidate needs support (few of the probes through
// it may join one side with itself) and edges (lines must fill it). Openings beside each other in
// one plane are joined, as panes; then each needs a share of the camera's light; then those that
// stand beside each other are separated.
#include "tools/portalfit/portalfit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "libcommon/base/counted.h"
#include "libcommon/base/number_words.h"
#include "libcommon/formats/viewpoint.h"
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
constexpr double kLeastTogether = 0.1;  // of a cut's light, through all its openings
constexpr double kSparse = 0.2;         // of the density of other openings of the cut
constexpr double kLeastPassing = 0.25;  // of a candidate's lines: support times fullness
// A plane that the light is not wider before and behind, on one side at least, bounds nothing.
constexpr double kLeastWidening = 1.5;
constexpr size_t kMostTried = 48;  // candidates per cut
// Least support of a single opening: a plane across a corner with windows on both sides has less.
constexpr double kOneOpening = 0.9;
constexpr double kFull = 0.5;  // of the fullest voxel, for the paper's rule
constexpr double kDegrees = 180 / std::numbers::pi;

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

std::vector<Vec3d> corners_of(const Aperture& a) {
  std::vector<Vec3d> corners;
  for (const Vec2d& p : a.polygon) corners.push_back(to_space(a.tube.middle, p));
  return corners;
}

// Whether both are the same opening, found by the light of two cuts: seen along the other's normal
// the smaller one lies in the larger, and close to its plane.
bool same_opening(const Aperture& a, const Aperture& b, double voxel) {
  constexpr double kSameWay = 0.8;  // cosine
  constexpr double kOverlap = 0.5;  // of the smaller one's area
  constexpr double kDeep = 0.3;     // of its size
  if (dot(a.tube.middle.n, b.tube.middle.n) < kSameWay) return false;
  Polygon seen;
  Vec3d sum{};
  for (const Vec2d& p : a.polygon) {
    const Vec3d corner = to_space(a.tube.middle, p);
    sum += corner;
    seen.push_back(in_plane(b.tube.middle, corner));
  }
  const double smaller = std::min(area(seen), area(b.polygon));
  const double off =
      dot(sum / static_cast<double>(a.polygon.size()) - b.tube.middle.o, b.tube.middle.n);
  if (std::abs(off) > std::max(kDeep * std::sqrt(smaller), voxel)) return false;
  for (size_t i = 0; i < b.polygon.size() && seen.size() > 2; ++i) {
    const Vec2d p = b.polygon[i], d = b.polygon[(i + 1) % b.polygon.size()] - p;
    const Vec2d outside{d.y, -d.x};
    seen = clipped(seen, outside, dot(p, outside));
  }
  return seen.size() > 2 && area(seen) > kOverlap * smaller;
}

// Share of each camera's light that each line stands for; without knowledge of it all lines of a
// cut have the same.
std::vector<std::vector<double>> shares_of(const LightGrid& grid) {
  std::vector<double> of_cut(kMostCuts, 0), count(kMostCuts, 0);
  for (const LightLine& line : grid.lines) of_cut[line.cut] += line.share, count[line.cut] += 1;
  std::vector<std::vector<double>> shares(grid.number_of_cameras());
  for (size_t k = 0; k < shares.size(); ++k)
    for (size_t i = 0; i < grid.lines.size(); ++i) {
      const uint32_t cut = grid.lines[i].cut;
      shares[k].push_back(of_cut[cut] > 0 ? grid.share_of(k, i) : 1 / count[cut]);
    }
  return shares;
}

// The names by which portals list the cameras that they serve; none for one camera.
std::vector<std::string> names_of_cameras(const LightGrid& grid) {
  std::vector<std::string> names;
  for (size_t k = 0; k < grid.shares.size(); ++k) {
    const auto viewpoint = parse_viewpoint(k < grid.cameras.size() ? grid.cameras[k] : "");
    names.push_back(viewpoint ? viewpoint->name : "");
  }
  return names;
}

double largest(const std::vector<double>& shares) {
  return *std::max_element(shares.begin(), shares.end());
}

std::string at_least(double share) {
  return fmt::format("at least {}", percent_words(share));
}

// Fits the openings of a grid.
class Fit {
 public:
  Fit(const LightGrid& grid, const PortalFitOptions& options)
      : grid_(grid), options_(options), shares_(shares_of(grid)), names_(names_of_cameras(grid)) {}

  FitResult run() {
    std::vector<Bundle> of_cut;
    for (uint32_t l = 0; l < grid_.lines.size(); ++l) {
      const uint32_t c = grid_.lines[l].cut;
      if (c >= of_cut.size()) of_cut.resize(c + 1, {&grid_.lines});
      of_cut[c].which.push_back(l);
    }
    std::vector<Aperture> found;
    size_t explained = 0;
    for (const Bundle& lines : of_cut) {
      if (lines.empty()) continue;
      std::set<uint32_t> crossed;
      for (Aperture& a : fit_cut(lines)) {
        crossed.insert(a.lines.which.begin(), a.lines.which.end());
        found.push_back(std::move(a));
      }
      explained += crossed.size();
    }
    for (const Opening& opening : chosen(std::move(found))) {
      result_.portals.push_back(portal_of(opening));
      result_.lines.push_back(opening.aperture.lines.which);
    }
    result_.explained = static_cast<double>(explained) / static_cast<double>(grid_.lines.size());
    return std::move(result_);
  }

 private:
  // An opening, found by the light of one or several cuts.
  struct Opening {
    Aperture aperture;
    std::vector<double> light;  // share of each camera's that passes it; 0: it does not serve it
  };

  // Share of each camera's light.
  std::vector<double> lights_of(const Bundle& bundle) const {
    std::vector<double> sums;
    for (const std::vector<double>& of_camera : shares_) {
      double sum = 0;
      for (const uint32_t l : bundle.which) sum += of_camera[l];
      sums.push_back(sum);
    }
    return sums;
  }
  // Of the camera to which it means most.
  double light_of(const Bundle& bundle) const { return largest(lights_of(bundle)); }

  Portal portal_of(const Opening& opening) const {
    const Aperture& a = opening.aperture;
    Portal portal;
    for (size_t k = 0; k < names_.size(); ++k)
      if (opening.light[k] > 0) portal.cameras[names_[k]] = std::min(1.0, opening.light[k]);
    portal.vertices = corners_of(a);
    portal.triangles = triangulate(a.polygon);
    Vec3d sum{};
    for (const LightLine& line : a.lines.lines()) sum += normalize(line.camera - line.light);
    const Vec3d mean = normalize(sum);
    auto& f = portal.figures;
    f["area"] = area(a.polygon);
    f["flux_share"] = std::min(1.0, largest(opening.light));
    if (const auto support = support_of(grid_.probes, a)) f["support"] = *support;
    f["direction_x"] = mean.x;
    f["direction_y"] = mean.y;
    f["direction_z"] = mean.z;
    f["direction_angle"] = kDegrees * std::acos(std::clamp(dot(mean, a.tube.middle.n), -1.0, 1.0));
    if (const auto wider = widening_of(grid_, a)) f["widening"] = *wider;
    f["concentration"] = length(sum) / static_cast<double>(a.lines.size());
    const auto [main, minor] = pca_angles(grid_, a.tube.middle.n);
    f["pca_main_angle"] = main;
    f["pca_minor_angle"] = minor;
    return portal;
  }

  void refuse(const std::string& why, const std::string& limit = "",
              const std::vector<Aperture>& which = {}) {
    result_.refused.push_back({why, limit, {}});
    for (const Aperture& a : which) result_.refused.back().polygons.push_back(corners_of(a));
  }

  // Openings that the lines `all` of one cut pass, one by one, however little each carries.
  std::vector<Aperture> parts_of(const Bundle& all) {
    Bundle rest = all;
    std::vector<Aperture> parts;
    // Ends, since each candidate removes its lines.
    for (size_t tried = 0;
         tried < kMostTried && rest.size() >= kFewestLines && light_of(rest) >= options_.threshold;
         ++tried) {
      auto aperture = find_aperture(grid_, rest);
      if ((!aperture || aperture->lines.empty()) &&
          static_cast<double>(rest.size()) > kStrays * static_cast<double>(all.size()))
        aperture = aperture_of_directions(grid_, rest);
      if (!aperture || aperture->lines.empty()) {
        refuse("the lines left have no common waist");
        break;
      }
      ++result_.candidates;
      add_part(all, rest, std::move(*aperture), parts, rest);
      if (stuck_) break;
    }
    return parts;
  }

  // Judges a candidate among the lines `rest` of `all`, adds it or a better one to `parts`, and
  // removes its lines from `left`.
  void add_part(const Bundle& all, const Bundle& rest, Aperture aperture,
                std::vector<Aperture>& parts, Bundle& left) {
    if (auto part = denser_part(grid_, rest, aperture)) aperture = std::move(*part);
    auto support = support_of(grid_.probes, aperture);
    double passing = support.value_or(1) * fullness_of(aperture);
    // Lines that end before an opening found earlier may belong to this one, and a plane before two
    // windows at a corner has a denser part.
    const auto instead = [&](std::optional<Aperture> other) {
      if (!other || other->lines.empty()) return;
      aperture = std::move(*other);
      support = support_of(grid_.probes, aperture);
      passing = support.value_or(1) * fullness_of(aperture);
    };
    if (passing < kLeastPassing && !parts.empty())
      instead(find_aperture(grid_, lines_beside(all, parts)));
    if (passing < kLeastPassing || support.value_or(1) < kOneOpening)
      instead(part_of_directions(grid_, rest, aperture));
    if (support && *support < options_.support)
      refuse(fmt::format(
                 "a candidate lies within one side: only {:.0f} % of the lines through it join the "
                 "two",
                 100 * *support),
             at_least(options_.support), {aperture});
    else if (passing < kLeastPassing)
      refuse(fmt::format("a candidate of {} m2 lies in the open: only {:.0f} % of "
                         "the lines through it pass from one side to the other",
                         number_words(area(aperture.polygon), 2), 100 * passing),
             at_least(kLeastPassing), {aperture});
    else if (const double wider = widening_of(grid_, aperture).value_or(kLeastWidening);
             wider < kLeastWidening)
      refuse(fmt::format("a candidate of {} m2 lies across a room: the light is only {} times as "
                         "wide before or behind it",
                         number_words(area(aperture.polygon), 2), number_words(wider, 2)),
             fmt::format("at least {}", kLeastWidening), {aperture});
    else if (aperture.lines.size() >= kFewestLines &&
             light_of(aperture.lines) >= kLeastPart * options_.threshold)
      parts.push_back(aperture);
    Bundle without = lines_not_at(rest, aperture);
    stuck_ = without.size() == rest.size();
    left = std::move(without);
  }

  // Removes openings with far fewer lines per etendue than others of about as many lines: they are
  // leaks, spread over a large plane.
  void leave_out_sparse(std::vector<Aperture>& found) {
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
        refuse(fmt::format("a candidate of {} m2 lies in the open: others pass as many lines in a "
                           "fifth of its area",
                           number_words(area(a.polygon), 2)),
               "", {a});
    }
    found = std::move(left);
  }

  // Keeps the openings that carry enough light, the most first.
  std::vector<Aperture> enough_light(std::vector<Aperture> found) {
    sort_by_light(found);
    std::vector<Aperture> enough, weak;
    double too_little = 0;
    for (Aperture& a : found)
      if (const double share = light_of(a.lines); share < options_.threshold)
        too_little += share, weak.push_back(std::move(a));
      else
        enough.push_back(std::move(a));
    if (!weak.empty())
      refuse(fmt::format("{} {} {:.1f} % of the camera's light only", weak.size(),
                         weak.size() == 1 ? "candidate carries" : "candidates together carry",
                         100 * too_little),
             at_least(options_.threshold), weak);
    return enough;
  }

  void sort_by_light(std::vector<Aperture>& found) const {
    std::stable_sort(found.begin(), found.end(), [&](const Aperture& a, const Aperture& b) {
      return light_of(a.lines) > light_of(b.lines);
    });
  }

  // The openings of one cut with the lines `all`, those with most light first.
  std::vector<Aperture> fit_cut(const Bundle& all) {
    const double light = light_of(all);
    if (light < options_.threshold) {
      refuse(fmt::format("{} of the camera's light crosses a cut: it is not fitted",
                         percent_words(light)),
             at_least(options_.threshold));
      return {};
    }
    std::vector<Aperture> found =
        joined_in_planes(all, parts_of(all), std::numeric_limits<size_t>::max(), grid_.voxel);
    leave_out_sparse(found);
    found = enough_light(std::move(found));
    if (found.size() > options_.max_portals)
      found =
          enough_light(joined_in_planes(all, std::move(found), options_.max_portals, grid_.voxel));
    part_from_each_other(all, found, grid_.voxel);
    part_at_shared_edges(all, found);
    const double together = together_of(all, found);
    if (!found.empty() && together < kLeastTogether) {
      refuse(fmt::format("{} of a cut pass only {} of its light: it leaks elsewhere",
                         counted(found.size(), "opening"), percent_words(together)),
             at_least(kLeastTogether));
      return {};
    }
    return found;
  }

  // Share of the light of a cut that passes its openings; of the camera for which that is most.
  double together_of(const Bundle& all, const std::vector<Aperture>& found) const {
    const std::vector<double> whole = lights_of(all);
    std::vector<double> sum(whole.size(), 0);
    for (const Aperture& a : found) {
      const std::vector<double> light = lights_of(a.lines);
      for (size_t k = 0; k < sum.size(); ++k) sum[k] += light[k];
    }
    for (size_t k = 0; k < sum.size(); ++k) sum[k] = whole[k] > 0 ? sum[k] / whole[k] : 0;
    return largest(sum);
  }

  // Of the openings of all cuts those with most light, each once.
  std::vector<Opening> chosen(std::vector<Aperture> found) {
    sort_by_light(found);
    std::vector<Opening> kept;
    for (Aperture& a : found) {
      const std::vector<double> light = lights_of(a.lines);
      const auto same = std::find_if(kept.begin(), kept.end(), [&](const Opening& b) {
        return same_opening(a, b.aperture, grid_.voxel);
      });
      if (same == kept.end()) {
        kept.push_back({std::move(a), light});
        continue;
      }
      ++result_.repeated;
      for (size_t k = 0; k < light.size(); ++k) same->light[k] = std::max(same->light[k], light[k]);
    }
    limit_each_camera(kept);
    return kept;
  }

  // Leaves of each camera the openings with most of its light. An opening serves the camera to
  // which it means most, and others from the threshold on.
  void limit_each_camera(std::vector<Opening>& kept) {
    std::vector<double> most;
    for (const Opening& opening : kept) most.push_back(largest(opening.light));
    for (size_t k = 0; k < shares_.size(); ++k) {
      std::vector<Opening*> of_camera;
      for (size_t i = 0; i < kept.size(); ++i)
        if (double& light = kept[i].light[k]; light >= std::min(options_.threshold, most[i]))
          of_camera.push_back(&kept[i]);
        else
          light = 0;
      std::stable_sort(of_camera.begin(), of_camera.end(), [&](const Opening* a, const Opening* b) {
        return a->light[k] > b->light[k];
      });
      for (size_t i = options_.max_portals; i < of_camera.size(); ++i) of_camera[i]->light[k] = 0;
    }
    const size_t before = kept.size();
    std::erase_if(kept, [](const Opening& opening) { return !(largest(opening.light) > 0); });
    result_.repeated += before - kept.size();
  }

  const LightGrid& grid_;
  const PortalFitOptions& options_;
  const std::vector<std::vector<double>> shares_;  // of each camera, per line
  const std::vector<std::string> names_;           // of several cameras
  FitResult result_;
  bool stuck_ = false;  // the last candidate removed no line
};

}  // namespace

FitResult fit_portals(const LightGrid& grid, const PortalFitOptions& options) {
  FitResult result;
  if (!grid.bottleneck || grid.lines.empty()) return result;
  if (!options.by_paper) return Fit(grid, options).run();
  result.candidates = 1;
  if (auto found = portal_by_paper(grid, kFull)) {
    result.portals.push_back(std::move(found->portal));
    result.explained =
        static_cast<double>(found->lines.size()) / static_cast<double>(grid.lines.size());
    result.lines.push_back(std::move(found->lines));
  }
  return result;
}

}  // namespace tdpt
