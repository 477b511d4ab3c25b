#include "tools/portalfit/opening.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>

#include "tools/portalfit/plane.h"

namespace tdpt {
namespace {

// Decides which openings are one.
//
// Method: agglomerative clustering of flat shapes. The pair that leaves most of its joint outline
// open is joined first. A portal over bars loses, in tightness, the share that they cover; a portal
// for each gap between them costs a technique each, and narrow gaps are fitted badly. So panes are
// joined across bars, but windows are not joined across the wall between them.

// Least-squares plane of the points, with heights measured along the normal of `first`.
Plane nearest_plane(const Plane& first, const std::vector<Vec3d>& places) {
  const Onb<double> frame(first.n);
  double n = 0, xx = 0, xy = 0, yy = 0, xh = 0, yh = 0;
  Vec3d mean{};
  for (const Vec3d& p : places) mean += p, ++n;
  mean = mean / n;
  for (const Vec3d& p : places) {
    const Vec3d d = p - mean;
    const double x = dot(d, frame.x), y = dot(d, frame.y), h = dot(d, first.n);
    xx += x * x, xy += x * y, yy += y * y, xh += x * h, yh += y * h;
  }
  const double det = xx * yy - xy * xy;
  if (!(det > 1e-9 * (xx + yy) * (xx + yy))) return {mean, first.n};
  const double a = (xh * yy - yh * xy) / det, b = (yh * xx - xh * xy) / det;
  return {mean, normalize(first.n - frame.x * a - frame.y * b)};
}

double distance_from_edge(Vec2d p, Vec2d a, Vec2d b) {
  const Vec2d d = b - a;
  const double along = dot(d, d) > 0 ? std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0) : 0;
  const Vec2d off = p - a - d * along;
  return std::sqrt(dot(off, off));
}

double from_corners(const Polygon& corners, const Polygon& edges) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec2d& p : corners) {
    if (contains(edges, p)) return 0;
    for (size_t i = 0; i < edges.size(); ++i)
      least = std::min(least, distance_from_edge(p, edges[i], edges[(i + 1) % edges.size()]));
  }
  return least;
}

Polygon outline_in(const Plane& plane, const std::vector<Aperture>& parts) {
  std::vector<Vec2d> corners;
  for (const Aperture& a : parts)
    for (const Vec3d& p : corners_of(a)) corners.push_back(in_plane(plane, p));
  return convex_hull(corners);
}

using Group = std::vector<Aperture>;

// Merit of joining two groups of parts: the share left open; 0 if they stay apart.
double worth_joining(const Group& a, const Group& b, bool too_many, const LightGrid& grid) {
  Group both = a;
  both.insert(both.end(), b.begin(), b.end());
  const Joint joint = joint_of(grid, both);
  if (!joint.flat || joint.open < kMost) return 0;
  if (too_many) return joint.open;
  const Polygon one = outline_in(joint.plane, a), other = outline_in(joint.plane, b);
  const double bar = distance_between(one, other);
  if (bar <= kResolved * grid.voxel) return joint.open;
  // The corners of a rectangle spread like a larger rectangle.
  const double side =
      std::min(extents_of(one).shorter, extents_of(other).shorter) / std::numbers::sqrt3;
  return joint.open >= kMostly && bar <= kBeside * side ? joint.open : 0;
}

// Joins the best pair; returns false if there is none.
bool join_best(std::vector<Group>& groups, std::vector<std::vector<double>>& worth, bool too_many,
               const LightGrid& grid) {
  size_t best_a = 0, best_b = 0;
  double best = 0;
  for (size_t a = 0; a < groups.size(); ++a)
    for (size_t b = a + 1; b < groups.size(); ++b) {
      double& w = worth[a][b];
      if (w < 0) w = worth_joining(groups[a], groups[b], too_many, grid);
      if (w > best) best = w, best_a = a, best_b = b;
    }
  if (!(best > 0)) return false;
  groups[best_a].insert(groups[best_a].end(), groups[best_b].begin(), groups[best_b].end());
  groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(best_b));
  worth.erase(worth.begin() + static_cast<std::ptrdiff_t>(best_b));
  for (auto& row : worth) row.erase(row.begin() + static_cast<std::ptrdiff_t>(best_b));
  for (size_t k = 0; k < groups.size(); ++k) worth[best_a][k] = worth[k][best_a] = -1;
  return true;
}

// Fits one opening to the lines of all parts; returns the parts if that fails.
std::vector<Aperture> refitted(const LightGrid& grid, const Bundle& all, const Group& parts) {
  std::set<uint32_t> which;
  for (const Aperture& a : parts) which.insert(a.lines.which.begin(), a.lines.which.end());
  const std::vector<LightLine> lines = Bundle{all.of, {which.begin(), which.end()}}.lines();
  const Tube start{joint_of(grid, parts).plane, 0};
  Aperture a{turned_into_wall(lines, holding_plane(lines, start), grid.walls), {}, {}};
  std::vector<Vec2d> places;
  for (const LightLine& line : lines)
    if (const auto at = clear_crossing(a.tube.middle, line)) places.push_back(*at);
  if (places.size() < kFewestLines) return parts;
  a.polygon = outline_of(places);
  if (a.polygon.empty()) return parts;
  a.lines = lines_across(all, a);
  return {a};
}

}  // namespace

Joint joint_of(const LightGrid& grid, const std::vector<Aperture>& parts) {
  Plane first{{}, {}};
  std::vector<Vec3d> corners;
  double whole = 0;
  for (const Aperture& a : parts) {
    first.n += a.tube.middle.n * area(a.polygon);
    whole += area(a.polygon);
    const auto own = corners_of(a);
    corners.insert(corners.end(), own.begin(), own.end());
  }
  Joint joint;
  if (!(length(first.n) > 0.5 * whole)) return joint;
  first.n = normalize(first.n);
  joint.plane = nearest_plane(first, corners);
  std::vector<Vec2d> flat;
  double high = 0;
  for (const Vec3d& p : corners) {
    flat.push_back(in_plane(joint.plane, p));
    high = std::max(high, std::abs(dot(p - joint.plane.o, joint.plane.n)));
  }
  joint.outline = convex_hull(flat);
  if (joint.outline.size() < 3) return joint;
  double open = 0;
  bool faces = true;
  for (const Aperture& a : parts) {
    const double cosine = dot(a.tube.middle.n, joint.plane.n);
    open += area(a.polygon) * cosine;
    faces = faces && cosine > kNearlyParallel;
  }
  joint.open = open / area(joint.outline);
  const double side = extents_of(joint.outline).shorter;
  joint.flat = faces && high <= std::max(grid.voxel, kBeside * side);
  return joint;
}

double distance_between(const Polygon& a, const Polygon& b) {
  return std::min(from_corners(a, b), from_corners(b, a));
}

std::vector<Aperture> joined_in_planes(const LightGrid& grid, const Bundle& all,
                                       std::vector<Aperture> parts, size_t most) {
  const bool too_many = parts.size() > most;
  std::vector<Group> groups;
  for (Aperture& a : parts) groups.push_back({std::move(a)});
  std::vector worth(groups.size(), std::vector<double>(groups.size(), -1));  // -1: unknown
  while (groups.size() > (too_many ? most : 1) && join_best(groups, worth, too_many, grid)) {
  }
  std::vector<Aperture> joined;
  for (const Group& group : groups) {
    const auto openings = group.size() > 1 ? refitted(grid, all, group) : group;
    joined.insert(joined.end(), openings.begin(), openings.end());
  }
  return joined;
}

void part_from_each_other(const LightGrid& grid, const Bundle& all, std::vector<Aperture>& found) {
  if (found.size() < 2) return;
  for (const double growth : {kWidening, std::sqrt(kWidening), 1.0}) {
    for (Aperture& a : found) {
      std::vector<uint32_t> others;
      for (const Aperture& b : found) {
        if (&b == &a) continue;
        Aperture wider = b;
        wider.polygon = enlarged(b.polygon, growth);
        const Bundle across = lines_across(all, wider);
        others.insert(others.end(), across.which.begin(), across.which.end());
      }
      std::sort(others.begin(), others.end());
      const auto without = [&](const Bundle& lines) {
        Bundle left{all.of};
        std::set_difference(lines.which.begin(), lines.which.end(), others.begin(), others.end(),
                            std::back_inserter(left.which));
        return left;
      };
      const auto shared = static_cast<double>(a.lines.size() - without(a.lines).size());
      const auto size = static_cast<double>(a.lines.size());
      if (shared < kSlight * size || shared > 0.5 * size) continue;
      auto again = outlined(grid, without(all), a.tube, true);
      if (!again) continue;
      again->lines = lines_across(all, *again);
      if (static_cast<double>(again->lines.size()) >= kPlaneHolds * size) a = std::move(*again);
    }
  }
}

}  // namespace tdpt
