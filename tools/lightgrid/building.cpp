#include "tools/lightgrid/lightgrid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tdpt {

bool triangle_touches_box(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& half) {
  const auto separated = [&](const Vec3d& axis) {
    const double pa = dot(axis, a), pb = dot(axis, b), pc = dot(axis, c);
    const double r =
        half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
    return std::min({pa, pb, pc}) > r || std::max({pa, pb, pc}) < -r;
  };
  const Vec3d axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec3d& axis : axes)
    if (separated(axis)) return false;
  const Vec3d edges[3] = {b - a, c - b, a - c};
  if (separated(cross(edges[0], edges[1]))) return false;
  for (const Vec3d& edge : edges)
    for (const Vec3d& axis : axes)
      if (separated(cross(edge, axis))) return false;
  return true;
}

namespace {

struct VoxelRange {
  std::array<int, 3> low, high;  // range of voxel indices, high excluded
};

// Halves the box down to single voxels: a large slanted triangle then costs its surface, not its
// box.
void mark_taken(LightGrid& grid, const Vec3d (&p)[3], const VoxelRange& box) {
  Vec3d middle, half;
  int widest = 0;
  for (int c = 0; c < 3; ++c) {
    const auto s = static_cast<size_t>(c);
    middle[c] = 0.5 * (box.low[s] + box.high[s]);
    half[c] = 0.5 * (box.high[s] - box.low[s]) + 1e-6;  // contact counts, despite rounding
    if (box.high[s] - box.low[s] >
        box.high[static_cast<size_t>(widest)] - box.low[static_cast<size_t>(widest)])
      widest = c;
  }
  const auto w = static_cast<size_t>(widest);
  const bool single = box.high[w] - box.low[w] == 1;
  uint8_t& air = grid.air[grid.index(box.low[0], box.low[1], box.low[2])];
  if (single && __atomic_load_n(&air, __ATOMIC_RELAXED) == 0) return;
  if (!triangle_touches_box(p[0] - middle, p[1] - middle, p[2] - middle, half)) return;
  if (single) return __atomic_store_n(&air, uint8_t{0}, __ATOMIC_RELAXED);
  const int split = (box.low[w] + box.high[w]) / 2;
  VoxelRange first = box, second = box;
  first.high[w] = second.low[w] = split;
  mark_taken(grid, p, first);
  mark_taken(grid, p, second);
}

}  // namespace

void mark_air(const Scene& scene, LightGrid& grid) {
  grid.air.assign(grid.count.size(), 1);
  tbb::parallel_for(
      tbb::blocked_range<uint32_t>(0, static_cast<uint32_t>(scene.triangles.size()), 256),
      [&](const auto& range) {
        for (uint32_t t = range.begin(); t < range.end(); ++t) {
          Vec3d p[3];
          for (int v = 0; v < 3; ++v)
            p[v] = (scene.frame.to_metres(Vec3d(scene.vertex(t, v))) - grid.origin) / grid.voxel;
          const Vec3d low = min(p[0], min(p[1], p[2])), high = max(p[0], max(p[1], p[2]));
          VoxelRange box;
          bool empty = false;
          for (int c = 0; c < 3; ++c) {
            const auto s = static_cast<size_t>(c);
            box.low[s] = std::max(0, static_cast<int>(std::floor(low[c] - 1e-6)));
            box.high[s] = std::min(grid.dim[s], static_cast<int>(std::floor(high[c] + 1e-6)) + 1);
            empty = empty || box.low[s] >= box.high[s];
          }
          if (!empty) mark_taken(grid, p, box);
        }
      });
}

namespace {

// ---- Walls ----

// Finds the directions in which the walls of a building face.
//
// Method: the peaks of an extended Gaussian image, the histogram of surface area over normals
// (Horn 1984). Areas are summed in cells of a degree; from the fullest cell on, each takes those
// within two degrees. Two peaks at right angles give the third axis of their frame: the short walls
// of a long building are little surface.

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

namespace {

// ---- Panes ----

// Finds the sheets of solid glass: pairs of flat faces that look away from each other.
//
// Method: triangles of glass are summed by plane, in cells of a degree and a tenth of a millimetre;
// each face, the largest first, is paired with the nearest face behind it that looks the other way.

constexpr double kSheet = 0.5;                 // of the width: thicker glass is a block
constexpr double kParallel = 0.99939;          // cosine of two degrees
constexpr double kDepth = 1e-4;                // of a cell of planes [m]
constexpr size_t kMostFaces = 8 * kMostPanes;  // that are looked at, the largest

// Triangles in one plane that face one way; n is as long as their area.
struct Face {
  Vec3d n{}, moment{};
  Vec3d normal() const { return normalize(n); }
  Vec3d place() const { return moment / length(n); }
};

// Flat faces of glass, the largest first.
std::vector<Face> flat_faces(const Scene& scene) {
  std::map<std::array<long, 4>, Face> by_plane;
  const size_t surfaces = std::min<size_t>(scene.dome, scene.triangles.size());
  for (size_t t = 0; t < surfaces; ++t) {
    const Material& m = scene.materials[scene.triangles[t].material];
    if (!m.solid || !(m.transmission > 0)) continue;
    const TriangleShape s = shape_of(scene, static_cast<uint32_t>(t));
    if (!(s.area > 0)) continue;
    const Vec3d middle = scene.frame.to_metres(s.p0 + (s.e1 + s.e2) / 3);
    const auto cell = [](double v, double size) { return std::lround(v / size); };
    Face& face = by_plane[{cell(s.normal.x, kCell), cell(s.normal.y, kCell),
                           cell(s.normal.z, kCell), cell(dot(s.normal, middle), kDepth)}];
    face.n += s.normal * s.area;
    face.moment += middle * s.area;
  }
  std::vector<Face> faces;
  for (const auto& [plane, face] : by_plane) faces.push_back(face);
  std::stable_sort(faces.begin(), faces.end(),
                   [](const Face& a, const Face& b) { return length(a.n) > length(b.n); });
  if (faces.size() > kMostFaces) faces.resize(kMostFaces);
  return faces;
}

}  // namespace

std::vector<GridPane> solid_panes(const Scene& scene) {
  const std::vector<Face> faces = flat_faces(scene);
  std::vector<GridPane> panes;
  std::vector<uint8_t> paired(faces.size(), 0);
  for (size_t f = 0; f < faces.size() && panes.size() < kMostPanes; ++f) {
    const Vec3d n = faces[f].normal(), at = faces[f].place();
    double thick = kSheet * std::sqrt(length(faces[f].n)) / scene.frame.scale;
    size_t other = f;
    for (size_t g = 0; g < faces.size(); ++g)
      if (dot(faces[g].normal(), n) < -kParallel)
        if (const double t = dot(at - faces[g].place(), n); t > 0 && t < thick)
          thick = t, other = g;
    if (other == f || paired[f]) continue;
    paired[f] = paired[other] = 1;
    panes.push_back({at, at - n * thick});
  }
  return panes;
}

}  // namespace tdpt
