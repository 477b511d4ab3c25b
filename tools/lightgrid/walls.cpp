// Finds the directions in which the walls of a building face.
//
// Method: the peaks of an extended Gaussian image, the histogram of surface area over normals
// (Horn 1984). Areas are summed in cells of a degree; from the fullest cell on, each takes those
// within two degrees. Two peaks at right angles give the third axis of their frame: the short walls
// of a long building are little surface.
#include "tools/lightgrid/walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace tdpt {
namespace {

constexpr double kLeastSurface = 0.02;  // of that in the box
constexpr double kSameWay = 0.99939;    // cosine of two degrees
constexpr double kSquare = 0.0175;      // cosine of 89 degrees
constexpr double kCell = 1 / 57.3;      // a degree
constexpr size_t kMostCells = 64;

// One of n and -n, the same for both.
Vec3d without_side(const Vec3d& n) {
  const Vec3d size = max(n, -n);
  const double first = size.x >= 0.5 ? n.x : size.y >= 0.5 ? n.y : n.z;
  return first < 0 ? -n : n;
}

bool is_among(const std::vector<Vec3d>& directions, const Vec3d& n) {
  return std::any_of(directions.begin(), directions.end(),
                     [&](const Vec3d& other) { return std::abs(dot(other, n)) >= kSameWay; });
}

}  // namespace

std::vector<Vec3d> wall_directions(const Scene& scene, const LightGrid& grid) {
  const Vec3d low = scene.frame.to_canonical(grid.origin);
  const Vec3d high = scene.frame.to_canonical(
      grid.origin + Vec3d{1.0 * grid.dim[0], 1.0 * grid.dim[1], 1.0 * grid.dim[2]} * grid.voxel);
  std::map<std::array<int, 3>, Vec3d> by_cell;  // sum of normals, as long as the area
  double all = 0;
  const size_t surfaces = std::min<size_t>(scene.dome, scene.triangles.size());
  for (size_t t = 0; t < surfaces; ++t) {
    const auto& v = scene.triangles[t].vertex;
    const Vec3d a(scene.positions[v[0]]), b(scene.positions[v[1]]), c(scene.positions[v[2]]);
    const Vec3d least = min(a, min(b, c)), most = max(a, max(b, c));
    if (!(least.x <= high.x && least.y <= high.y && least.z <= high.z)) continue;
    if (!(most.x >= low.x && most.y >= low.y && most.z >= low.z)) continue;
    const Vec3d n = cross(b - a, c - a);
    const double size = length(n);
    if (!(size > 0)) continue;
    const Vec3d way = without_side(n / size);
    by_cell[{static_cast<int>(std::lround(way.x / kCell)),
             static_cast<int>(std::lround(way.y / kCell)),
             static_cast<int>(std::lround(way.z / kCell))}] += way * size;
    all += size;
  }
  std::vector<Vec3d> cells;
  for (const auto& [cell, sum] : by_cell) cells.push_back(sum);
  std::stable_sort(cells.begin(), cells.end(),
                   [](const Vec3d& a, const Vec3d& b) { return length(a) > length(b); });
  std::vector<Vec3d> sums;
  for (const Vec3d& cell : cells) {
    const Vec3d way = normalize(cell);
    const auto same = std::find_if(sums.begin(), sums.end(), [&](const Vec3d& sum) {
      return std::abs(dot(normalize(sum), way)) >= kSameWay;
    });
    if (same == sums.end()) {
      if (sums.size() < kMostCells) sums.push_back(cell);
    } else {
      *same += dot(*same, way) < 0 ? -cell : cell;
    }
  }
  std::stable_sort(sums.begin(), sums.end(),
                   [](const Vec3d& a, const Vec3d& b) { return length(a) > length(b); });
  std::erase_if(sums, [&](const Vec3d& sum) { return length(sum) < kLeastSurface * all; });
  std::vector<Vec3d> directions;
  for (const Vec3d& sum : sums) directions.push_back(normalize(sum));
  const size_t own = directions.size();
  for (size_t a = 0; a < own; ++a)
    for (size_t b = 0; b < a; ++b)
      if (std::abs(dot(directions[a], directions[b])) < kSquare)
        if (const Vec3d third = normalize(cross(directions[a], directions[b]));
            !is_among(directions, third))
          directions.push_back(third);
  if (directions.size() > kMostWalls) directions.resize(kMostWalls);
  return directions;
}

}  // namespace tdpt
