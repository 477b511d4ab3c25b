#include "tools/lightgrid/patch_map.h"

#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"

namespace tdpt {
namespace {

double cell_size(const PatchGrid& grid, int level) {
  return std::ldexp(grid.base_cell, -2 * level);
}

std::array<int32_t, 3> cell_of(const PatchGrid& grid, int level, const Vec3d& metres) {
  const Vec3d p = (metres - grid.origin) / cell_size(grid, level);
  std::array<int32_t, 3> cell;
  for (int c = 0; c < 3; ++c)
    cell[static_cast<size_t>(c)] = static_cast<int32_t>(std::clamp(std::floor(p[c]), -2e9, 2e9));
  return cell;
}

// One cut of Sutherland and Hodgman: keeps the part of the polygon with sign*(p[axis] - at) >= 0.
void clip(std::vector<Vec3d>& polygon, int axis, double at, double sign) {
  std::vector<Vec3d> kept;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec3d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double dp = sign * (p[axis] - at), dq = sign * (q[axis] - at);
    if (dp >= 0) kept.push_back(p);
    if ((dp >= 0) != (dq >= 0)) kept.push_back(p + (q - p) * (dp / (dp - dq)));
  }
  polygon = std::move(kept);
}

}  // namespace

PatchMap::PatchMap(const Scene& scene, const CutFile& cut, const std::string& cut_name)
    : scene_(scene), cut_(cut), first_(2 * scene.triangles.size() + 1, 0) {
  for (size_t i = 0; i < cut.patches.size(); ++i) {
    const Patch& patch = cut.patches[i];
    if (std::find(levels_.begin(), levels_.end(), patch.level) == levels_.end())
      levels_.push_back(patch.level);
    for (const uint32_t face : patch.faces) {
      if (face / 2 >= scene.triangles.size())
        throw InputError(display_name(cut_name), fmt::format("patch {}", i),
                         fmt::format("names triangle {}, but the scene has {}", face / 2,
                                     scene.triangles.size()));
      ++first_[face + 1];
    }
  }
  std::sort(levels_.rbegin(), levels_.rend());
  std::partial_sum(first_.begin(), first_.end(), first_.begin());

  // Patches are handed out to their faces in order, so each face has its own in order.
  std::vector<uint32_t> order(cut.patches.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](uint32_t a, uint32_t b) { return place(a) < place(b); });
  patches_.resize(first_.back());
  std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
  for (const uint32_t patch : order)
    for (const uint32_t face : cut.patches[patch].faces) patches_[next[face]++] = patch;
}

std::optional<uint32_t> PatchMap::region_at(uint32_t face, const Vec3d& position) const {
  const auto begin = patches_.begin() + first_[face], end = patches_.begin() + first_[face + 1];
  if (begin == end) return {};
  const Vec3d metres = scene_.frame.to_metres(position);
  for (const int level : levels_) {
    const Place wanted{level, cell_of(cut_.grid, level, metres)};
    const auto found = std::lower_bound(
        begin, end, wanted, [&](uint32_t patch, const Place& p) { return place(patch) < p; });
    if (found != end && place(*found) == wanted) return cut_.region[*found];
  }
  return {};
}

PatchSurface::PatchSurface(const Scene& scene, const PatchGrid& grid, const Patch& patch) {
  const double size = cell_size(grid, patch.level);
  std::vector<double> areas;
  for (const uint32_t face : patch.faces) {
    const TriangleShape shape = shape_of(scene, face / 2);
    std::vector<Vec3d> polygon{shape.p0, shape.p0 + shape.e1, shape.p0 + shape.e2};
    for (int c = 0; c < 3 && !polygon.empty(); ++c) {
      const int32_t cell = patch.cell[static_cast<size_t>(c)];
      Vec3d low = grid.origin, high = grid.origin;
      low[c] += size * cell;
      high[c] += size * (cell + 1.0);
      clip(polygon, c, scene.frame.to_canonical(low)[c], 1);
      clip(polygon, c, scene.frame.to_canonical(high)[c], -1);
    }
    const Vec3d normal = face % 2 ? -shape.normal : shape.normal;
    for (size_t i = 2; i < polygon.size(); ++i) {
      const double area = 0.5 * length(cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]));
      if (!(area > 0)) continue;
      pieces_.push_back({polygon[0], polygon[i - 1], polygon[i], normal});
      areas.push_back(area);
      area_ += area;
    }
  }
  if (!pieces_.empty()) table_ = AliasTable(areas);
}

SurfacePoint PatchSurface::sample(Rng& rng) const {
  const double pick = rng.uniform(), u = rng.uniform(), v = rng.uniform();
  const Piece& piece = pieces_[table_.sample(pick)];
  double b1, b2;
  uniform_triangle(u, v, b1, b2);
  return {piece.a + (piece.b - piece.a) * b1 + (piece.c - piece.a) * b2, piece.normal};
}

}  // namespace tdpt
