#include "tools/portalfit/portalfit.h"

#include <algorithm>
#include <cmath>

#include "tools/portalfit/plane.h"

namespace tdpt {

VoxelAxes axes_of_full_voxels(const LightGrid& grid, double share) {
  VoxelAxes axes;
  if (grid.count.empty()) return axes;
  const float most = *std::max_element(grid.count.begin(), grid.count.end());
  for (size_t i = 0; i < grid.count.size(); ++i)
    if (grid.count[i] > 0 && grid.count[i] >= static_cast<float>(share) * most)
      axes.centres.push_back(centre_of(grid, i));
  if (axes.centres.empty()) return axes;
  for (const Vec3d& p : axes.centres) axes.mean += p;
  axes.mean = axes.mean / static_cast<double>(axes.centres.size());
  double c[3][3] = {};
  for (const Vec3d& p : axes.centres)
    for (int r = 0; r < 3; ++r)
      for (int s = 0; s < 3; ++s) c[r][s] += (p - axes.mean)[r] * (p - axes.mean)[s];
  // Jacobi rotations; the columns of v become the axes.
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int sweep = 0; sweep < 30; ++sweep)
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (c[p][q] == 0) continue;
        const double theta = 0.5 * std::atan2(2 * c[p][q], c[q][q] - c[p][p]);
        const double cs = std::cos(theta), sn = std::sin(theta);
        for (auto& row : c) {
          const double x = row[p], y = row[q];
          row[p] = cs * x - sn * y, row[q] = sn * x + cs * y;
        }
        for (int k = 0; k < 3; ++k) {
          const double x = c[p][k], y = c[q][k];
          c[p][k] = cs * x - sn * y, c[q][k] = sn * x + cs * y;
        }
        for (auto& row : v) {
          const double x = row[p], y = row[q];
          row[p] = cs * x - sn * y, row[q] = sn * x + cs * y;
        }
      }
  int main = 0, minor = 0;
  for (int i = 1; i < 3; ++i) {
    if (c[i][i] > c[main][main]) main = i;
    if (c[i][i] < c[minor][minor]) minor = i;
  }
  axes.main = {v[0][main], v[1][main], v[2][main]};
  axes.minor = {v[0][minor], v[1][minor], v[2][minor]};
  return axes;
}

FitResult portal_by_paper(const LightGrid& grid) {
  FitResult found;
  const VoxelAxes axes = axes_of_full_voxels(grid, kMost);
  if (axes.centres.empty()) return found;
  Vec3d light{};
  for (const LightLine& l : grid.lines) light += normalize(l.camera - l.light);
  const auto fullest = std::max_element(grid.count.begin(), grid.count.end()) - grid.count.begin();
  const Plane plane{centre_of(grid, static_cast<size_t>(fullest)),
                    dot(axes.main, light) < 0 ? -axes.main : axes.main};
  // Half the extent of a voxel along the normal.
  const Vec3d& n = plane.n;
  const double reach = 0.5 * grid.voxel * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  std::vector<Vec2d> points;
  for (const Vec3d& p : axes.centres)
    if (std::abs(dot(p - plane.o, n)) <= reach) points.push_back(in_plane(plane, p));
  const Polygon hull = convex_hull(points);
  // Voxels in one row have no width: the hull is rounding error.
  if (hull.size() < 3 || !(area(hull) > 1e-3 * grid.voxel * grid.voxel)) return found;
  Portal& portal = found.portals.emplace_back();
  std::vector<uint32_t>& lines = found.lines.emplace_back();
  for (const Vec2d& p : hull) portal.vertices.push_back(to_space(plane, p));
  portal.triangles = triangulate(hull);
  for (uint32_t l = 0; l < grid.lines.size(); ++l)
    if (const auto at = clear_crossing(plane, grid.lines[l]); at && contains(hull, *at))
      lines.push_back(l);
  found.explained = static_cast<double>(lines.size()) /
                    static_cast<double>(std::max<size_t>(grid.lines.size(), 1));
  portal.figures["area"] = area(hull);
  portal.figures["flux_share"] = found.explained;
  const double slant = std::abs(dot(light, plane.n)) / std::max(length(light), 1e-300);
  portal.figures["direction_angle"] = std::acos(std::min(1.0, slant)) * 57.29577951308232;
  return found;
}

}  // namespace tdpt
