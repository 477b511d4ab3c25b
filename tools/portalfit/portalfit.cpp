// Finds the planar openings that the light of a grid passes, cut by cut.
//
// Method: greedy (sequential) fitting, as sequential RANSAC finds planes: one aperture at a time,
// whose lines are deleted, until few are left. A candidate needs support (few of the probes through
// it may join one side with itself) and an edge (a wall, past which the air goes on before or
// behind). Openings beside each other in one plane are joined, as panes; then each needs a share of
// the camera's light; then what the light of one extends of another is cut back. What several cuts
// of a camera found is one opening if most of the light of either passes both; what several cameras
// found is one if that holds for both.
#include "tools/portalfit/portalfit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "libcommon/base/words.h"
#include "libcommon/formats/viewpoint.h"
#include "tools/portalfit/opening.h"
#include "tools/portalfit/plane.h"

namespace tdpt {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kBeforeGlass = 0.1;  // of its thickness: how far before it a portal stands

// Removes lines that come through the opening, or end within or close before it: they tell nothing
// of other openings.
Bundle lines_not_at(const Bundle& lines, const Aperture& a) {
  const Polygon wider = enlarged(a.polygon, kSimilarArea);
  const Extents e = extents_of(a.polygon);
  Tube deeper = a.tube;
  deeper.half += kBeside * e.shorter;
  const Slab slab(deeper);
  return lines.where([&](const LightLine& line) {
    const auto passage = slab.passage(line);
    if (!passage) return true;
    for (const double offset : {0.0, -a.tube.half, a.tube.half, -deeper.half, deeper.half})
      if (contains(wider, passage->at(offset))) return false;
    return true;
  });
}

// How far towards the camera the opening's plane is moved to lie before the solid glass that holds
// it, in the air [metres]; 0 where none does.
double way_out_of_glass(const LightGrid& grid, const Aperture& a) {
  const Vec3d n = a.tube.middle.n;
  const double most = kBeside * extents_of(a.polygon).shorter;
  double way = 0;
  // Two sheets may stand one behind the other.
  for (size_t again = 0; again < 2; ++again)
    for (const GridPane& pane : grid.panes) {
      const double thick = length(pane.back - pane.front);
      const Vec3d across = (pane.back - pane.front) / thick;
      const double cosine = dot(across, n);
      if (std::abs(cosine) < kNearlyParallel) continue;
      double low = INFINITY, high = -INFINITY;
      for (const Vec3d& corner : corners_of(a)) {
        const double depth = dot(corner + n * way - pane.front, across);
        low = std::min(low, depth), high = std::max(high, depth);
      }
      if (!(low < thick && high > 0)) continue;
      const double out = (cosine > 0 ? thick - low : high) + kBeforeGlass * thick;
      if (way + out / std::abs(cosine) <= most) way += out / std::abs(cosine);
    }
  return way;
}

// Whether they stand so near each other that they may be one opening, like the two narrow places
// beside a door ajar or the two faces of a thick wall.
bool may_be_one(const Aperture& a, const Aperture& b) {
  const auto ball = [](const Aperture& of) {
    const std::vector<Vec3d> corners = corners_of(of);
    Vec3d centre{};
    for (const Vec3d& c : corners) centre += c / static_cast<double>(corners.size());
    double radius = 0;
    for (const Vec3d& c : corners) radius = std::max(radius, length(c - centre));
    return std::pair{centre, radius};
  };
  const auto [centre_a, radius_a] = ball(a);
  const auto [centre_b, radius_b] = ball(b);
  return length(centre_a - centre_b) <= std::max(radius_a, radius_b);
}

// Share of its camera's light that each line stands for; without knowledge of it all lines of a cut
// have the same.
std::vector<double> shares_of(const LightGrid& grid) {
  std::vector<double> of_cut(kMostCuts, 0), count(kMostCuts, 0), shares;
  for (const LightLine& line : grid.lines) of_cut[line.cut] += line.share, count[line.cut] += 1;
  for (const LightLine& line : grid.lines)
    shares.push_back(of_cut[line.cut] > 0 ? line.share : 1 / count[line.cut]);
  return shares;
}

// The names by which portals list the cameras that they serve; none for one camera.
std::vector<std::string> names_of_cameras(const LightGrid& grid) {
  std::vector<std::string> names;
  for (size_t k = 0; grid.cameras.size() > 1 && k < grid.cameras.size(); ++k)
    names.push_back(parse_viewpoint(grid.cameras[k]).value_or(Viewpoint{}).name);
  return names;
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
    std::vector<std::vector<Aperture>> found(grid_.number_of_cameras());
    size_t explained = 0;
    for (const Bundle& lines : of_cut) {
      if (lines.empty()) continue;
      std::set<uint32_t> crossed;
      for (Aperture& a : fit_cut(lines)) {
        crossed.insert(a.lines.which.begin(), a.lines.which.end());
        found[grid_.camera_of(grid_.lines[lines.which[0]].cut)].push_back(std::move(a));
      }
      explained += crossed.size();
    }
    std::vector<Opening> openings;
    for (size_t k = 0; k < found.size(); ++k)
      merge(distinct_openings(std::move(found[k]), k), k, openings);
    std::stable_sort(openings.begin(), openings.end(), [](const Opening& a, const Opening& b) {
      return a.most_light() > b.most_light();
    });
    for (const Opening& opening : openings) {
      result_.portals.push_back(portal_of(opening));
      result_.lines.push_back(opening.aperture.lines.which);
    }
    result_.explained = static_cast<double>(explained) / static_cast<double>(grid_.lines.size());
    return std::move(result_);
  }

 private:
  // An opening that one or several cameras have found.
  struct Opening {
    Aperture aperture;
    std::vector<double> light;  // share of each camera's that passes it; 0: it does not serve it
    double most_light() const { return *std::max_element(light.begin(), light.end()); }
  };

  // Share of the light of the camera whose lines they are.
  double light_of(const Bundle& bundle) const {
    double sum = 0;
    for (const uint32_t l : bundle.which) sum += shares_[l];
    return sum;
  }

  Portal portal_of(const Opening& opening) const {
    const Aperture& a = opening.aperture;
    Portal portal;
    for (size_t k = 0; k < names_.size(); ++k)
      if (opening.light[k] > 0) portal.cameras[names_[k]] = std::min(1.0, opening.light[k]);
    portal.vertices = corners_of(a);
    const Vec3d out = a.tube.middle.n * way_out_of_glass(grid_, a);
    for (Vec3d& corner : portal.vertices) corner += out;
    portal.triangles = triangulate(a.polygon);
    Vec3d sum{};
    for (const LightLine& line : a.lines.lines()) sum += normalize(line.camera - line.light);
    const Vec3d mean = normalize(sum);
    auto& f = portal.figures;
    f["area"] = area(a.polygon);
    f["flux_share"] = std::min(1.0, opening.most_light());
    if (const auto support = support_of(grid_, a)) f["support"] = *support;
    f["direction_x"] = mean.x;
    f["direction_y"] = mean.y;
    f["direction_z"] = mean.z;
    f["direction_angle"] = kDegrees * std::acos(std::clamp(dot(mean, a.tube.middle.n), -1.0, 1.0));
    if (const auto edge = edge_share(grid_, a)) f["edge"] = *edge;
    f["concentration"] = length(sum) / static_cast<double>(a.lines.size());
    const VoxelAxes axes = axes_of_full_voxels(grid_, kMost);
    const auto angle = [&](const Vec3d& axis) {
      if (axes.centres.empty()) return 0.0;
      return kDegrees * std::acos(std::min(1.0, std::abs(dot(axis, a.tube.middle.n))));
    };
    f["pca_main_angle"] = angle(axes.main);
    f["pca_minor_angle"] = angle(axes.minor);
    return portal;
  }

  void refuse(const std::string& why, double least, const std::vector<Aperture>& which) {
    result_.refused.push_back({fmt::format("{}, less than {}", why, percent_words(least)), {}});
    for (const Aperture& a : which) result_.refused.back().polygons.push_back(corners_of(a));
  }

  // Without those that crowd where they have no waist, as at the corner of a room.
  Bundle without_crowd(const Bundle& lines) const {
    const Vec3d place = fullest_place(grid_, lines);
    return lines.where(
        [&](const LightLine& line) { return !passes_near(line, place, grid_.voxel); });
  }

  // Openings that the lines of one cut pass, one by one, however little each carries: each
  // candidate removes its lines.
  std::vector<Aperture> parts_of(const Bundle& all) {
    Bundle rest = all;
    std::vector<Aperture> parts;
    for (size_t before = 0; rest.size() != before && rest.size() >= kFewestLines &&
                            light_of(rest) >= options_.threshold;) {
      before = rest.size();
      auto found = find_aperture(grid_, rest);
      if (!found || found->lines.empty()) {
        rest = without_crowd(rest);
        continue;
      }
      if (support_of(grid_, *found).value_or(1) < kMostly)
        if (auto part = part_of_directions(grid_, rest, *found)) found = std::move(part);
      if (is_opening(*found) && found->lines.size() >= kFewestLines) parts.push_back(*found);
      rest = lines_not_at(rest, *found);
    }
    return parts;
  }

  // Whether a candidate lies between the two sides and bounds the light; otherwise refuses it.
  bool is_opening(const Aperture& a) {
    const double support = support_of(grid_, a).value_or(1),
                 edge = edge_share(grid_, a).value_or(1);
    if (support < kMost)
      refuse(fmt::format("a candidate lies within one side: only {:.0f} % of the lines through it "
                         "join the two",
                         100 * support),
             kMost, {a});
    else if (edge < options_.least_edge)
      refuse(fmt::format("a candidate of {} m2 lies across a room: only {:.0f} % of its outline is "
                         "an edge",
                         number_words(area(a.polygon), 2), 100 * edge),
             options_.least_edge, {a});
    return support >= kMost && edge >= options_.least_edge;
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
      refuse(fmt::format("by the network only {:.1f} % of the light crosses {}", 100 * too_little,
                         counted(weak.size(), "candidate")),
             options_.threshold, weak);
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
      refuse(fmt::format("by the network {} of the light crosses a cut that is not fitted",
                         percent_words(light)),
             options_.threshold, {});
      return {};
    }
    std::vector<Aperture> found =
        joined_in_planes(grid_, all, parts_of(all), std::numeric_limits<size_t>::max());
    found = enough_light(std::move(found));
    if (const auto most = static_cast<size_t>(options_.max_portals); found.size() > most)
      found = enough_light(joined_in_planes(grid_, all, std::move(found), most));
    part_from_each_other(grid_, all, found);
    return found;
  }

  // Share of the light of `a` that passes `b`, too.
  double passing(const Aperture& a, const Aperture& b) const {
    const Polygon wider = enlarged(b.polygon, kSimilarArea);
    const Bundle both = a.lines.where([&](const LightLine& line) {
      const auto at = crossing(b.tube.middle, line);
      return at && contains(wider, *at);
    });
    return light_of(both) / std::max(light_of(a.lines), 1e-300);
  }

  // Whether two cuts of a camera, or one cut twice, have found one opening.
  bool same_opening(const Aperture& a, const Aperture& b) const {
    return may_be_one(a, b) && std::max(passing(a, b), passing(b, a)) >= kMost;
  }

  // Whether each could stand for the other.
  bool interchangeable(const Aperture& a, const Aperture& b) const {
    return may_be_one(a, b) && std::min(passing(a, b), passing(b, a)) >= kMostly;
  }

  // The openings of all cuts of camera k that carry most light, each once: the smallest that passes
  // most of its light.
  std::vector<Opening> distinct_openings(std::vector<Aperture> found, size_t k) const {
    sort_by_light(found);
    std::vector<Opening> kept;
    for (Aperture& a : found) {
      const double light = light_of(a.lines);
      const auto same = std::find_if(kept.begin(), kept.end(),
                                     [&](const Opening& b) { return same_opening(a, b.aperture); });
      if (same == kept.end()) {
        kept.push_back({std::move(a), std::vector<double>(grid_.number_of_cameras(), 0)});
        kept.back().light[k] = light;
      } else if (area(a.polygon) < area(same->aperture.polygon) &&
                 light >= kMost * light_of(same->aperture.lines)) {
        same->aperture = std::move(a);
      }
    }
    kept.resize(std::min(kept.size(), static_cast<size_t>(options_.max_portals)));
    return kept;
  }

  // Merges those of camera k into those of the cameras before it.
  void merge(std::vector<Opening> of_camera, size_t k, std::vector<Opening>& all) const {
    for (Opening& opening : of_camera) {
      const auto same = std::find_if(all.begin(), all.end(), [&](const Opening& other) {
        return other.light[k] == 0 && interchangeable(opening.aperture, other.aperture);
      });
      if (same == all.end())
        all.push_back(std::move(opening));
      else
        same->light[k] = opening.light[k];
    }
  }

  const LightGrid& grid_;
  const PortalFitOptions& options_;
  const std::vector<double> shares_;      // per line
  const std::vector<std::string> names_;  // of several cameras
  FitResult result_;
};

}  // namespace

FitResult fit_portals(const LightGrid& grid, const PortalFitOptions& options) {
  if (!grid.bottleneck || grid.lines.empty()) return {};
  return options.method == "paper" ? portal_by_paper(grid) : Fit(grid, options).run();
}

}  // namespace tdpt
