#include "tools/lightgrid/line_tables.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/math/discrete.h"
#include "libcommon/scene/sky_bins.h"

namespace tdpt {

// ---- The dome of the sky ----

bool has_sky(const CutFile& cut) {
  return std::any_of(cut.patches.begin(), cut.patches.end(),
                     [](const Patch& p) { return p.is_sky(); });
}

namespace {

// Radius of the dome [canonical]: the direction to a bin varies by at most 3 degrees over a scene.
constexpr float kDomeRadius = 32;

}  // namespace

void add_sky_dome(Scene& scene) {
  scene.dome = static_cast<uint32_t>(scene.triangles.size());
  const auto material = static_cast<uint32_t>(scene.materials.size());
  scene.materials.emplace_back();
  for (uint32_t bin = 0; bin < kSkyBins; ++bin) {
    const auto first = static_cast<uint32_t>(scene.positions.size());
    for (const Vec3d& corner : sky_bin_corners(bin))
      scene.positions.push_back(Vec3f(corner) * kDomeRadius);
    scene.triangles.push_back({{first, first + 1, first + 2}, material});
  }
  const auto follow = [](auto& attributes, size_t count) {
    if (!attributes.empty()) attributes.resize(count);
  };
  const size_t n = scene.positions.size();
  follow(scene.normals, n);
  follow(scene.tangents, n);
  for (auto& uv : scene.uv) follow(uv, n);
  follow(scene.colours, n);
  follow(scene.smooth, scene.triangles.size());
}

namespace {

// ---- Tables ----

// One step of Sutherland-Hodgman clipping: keeps the part of the polygon with sign*(p[axis] - at)
// >= 0.
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

// Fills `threshold` and `alias` of slots first .. first + weights.size() (see PivotArc).
template <class Slot>
void fill_alias(std::vector<Slot>& slots, size_t first, const std::vector<double>& weights) {
  const AliasTable table(weights);
  for (uint32_t i = 0; i < weights.size(); ++i) {
    Slot& slot = slots[first + i];
    slot.threshold = static_cast<uint32_t>(std::min(table.threshold(i) * 0x1p32, 0x1p32 - 1));
    slot.alias = static_cast<uint32_t>(first) + table.alias(i);
  }
}

// The part of a patch's faces within its cell, as triangles with areas.
struct Surface {
  std::vector<shader::Piece> pieces;
  std::vector<double> areas;
};

// The face of a sky bin, seen from inside.
uint32_t dome_face(const Scene& scene, int32_t bin) {
  return 2 * (scene.dome + static_cast<uint32_t>(bin));
}

Surface surface_of(const Scene& scene, const PatchGrid& grid, const Patch& patch) {
  Surface out;
  if (patch.is_sky()) {
    const uint32_t face = dome_face(scene, patch.sky);
    out.pieces.push_back({scene.vertex(face / 2, 0), face, scene.vertex(face / 2, 1), 0,
                          scene.vertex(face / 2, 2), 0});
    out.areas.push_back(shape_of(scene, face / 2).area);
    return out;
  }
  const double size = std::ldexp(grid.base_cell, -2 * patch.level);
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
    for (size_t i = 2; i < polygon.size(); ++i) {
      const double area = 0.5 * length(cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]));
      if (!(area > 0)) continue;
      out.pieces.push_back(
          {Vec3f(polygon[0]), face, Vec3f(polygon[i - 1]), 0, Vec3f(polygon[i]), 0});
      out.areas.push_back(area);
    }
  }
  return out;
}

void add_surfaces(const Scene& scene, const CutFile& cut, LineTables& tables) {
  std::vector<bool> needed(cut.patches.size(), false);
  for (const CutArc& arc : cut.arcs) needed[arc.from] = needed[arc.to] = true;
  std::vector<Surface> surfaces(cut.patches.size());
  tbb::parallel_for(size_t{0}, needed.size(), [&](size_t i) {
    if (needed[i]) surfaces[i] = surface_of(scene, cut.grid, cut.patches[i]);
  });
  for (const Surface& s : surfaces) {
    const size_t first = tables.pieces.size();
    tables.patches.push_back(
        {static_cast<uint32_t>(first), static_cast<uint32_t>(s.pieces.size())});
    tables.pieces.insert(tables.pieces.end(), s.pieces.begin(), s.pieces.end());
    if (!s.pieces.empty()) fill_alias(tables.pieces, first, s.areas);
  }
}

void add_pairs(const CutFile& cut, LineTables& tables) {
  for (size_t c = 0; c < cut.cuts.size(); ++c) {
    const size_t first = tables.pivot_arcs.size();
    std::vector<double> capacities;
    for (const CutArc& arc : cut.arcs) {
      if (!cut.crosses(arc, c) || tables.patches[arc.from].count == 0 ||
          tables.patches[arc.to].count == 0)
        continue;
      tables.pivot_arcs.push_back({arc.from, arc.to, 0, 0});
      capacities.push_back(arc.capacity);
    }
    tables.cuts.push_back({static_cast<uint32_t>(first), static_cast<uint32_t>(capacities.size()),
                           cut.cuts[c].camera});
    if (!capacities.empty()) fill_alias(tables.pivot_arcs, first, capacities);
  }
}

// The region of each patch: a number for each distinct set of sides, in the order of the sets.
std::vector<uint32_t> add_regions(const CutFile& cut, LineTables& tables) {
  std::vector<uint64_t> distinct = cut.sides;
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  for (const uint64_t sides : distinct)
    for (const int word : {0, 1})
      tables.region_sides.push_back(static_cast<uint32_t>(sides >> (32 * word)));
  std::vector<uint32_t> region;
  for (const uint64_t sides : cut.sides)
    region.push_back(static_cast<uint32_t>(
        std::lower_bound(distinct.begin(), distinct.end(), sides) - distinct.begin()));
  return region;
}

void add_cells(const Scene& scene, const CutFile& cut, const std::string& cut_name,
               LineTables& tables) {
  tables.first_cell.assign(2 * scene.triangles.size() + 1, 0);
  const size_t surfaces = std::min<size_t>(scene.dome, scene.triangles.size());
  for (size_t i = 0; i < cut.patches.size(); ++i) {
    const Patch& patch = cut.patches[i];
    if (patch.is_sky()) {
      if (scene.dome >= scene.triangles.size())
        throw Error(Exit::internal, "a cut with a sky, a scene without its dome");
      ++tables.first_cell[dome_face(scene, patch.sky) + 1];
      continue;
    }
    tables.levels |= 1u << patch.level;
    for (const uint32_t face : patch.faces) {
      if (face / 2 >= surfaces)
        throw InputError(
            display_name(cut_name), fmt::format("patch {}", i),
            fmt::format("names triangle {}, but the scene has {}", face / 2, surfaces));
      ++tables.first_cell[face + 1];
    }
  }
  std::partial_sum(tables.first_cell.begin(), tables.first_cell.end(), tables.first_cell.begin());

  // Patches are assigned to their faces in order, so the patches of each face are sorted.
  std::vector<uint32_t> order(cut.patches.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const Patch &p = cut.patches[a], &q = cut.patches[b];
    return std::tie(p.level, p.cell) < std::tie(q.level, q.cell);
  });
  const std::vector<uint32_t> region = add_regions(cut, tables);
  tables.patch_cells.resize(tables.first_cell.back());
  tables.patch_of_cell.resize(tables.first_cell.back());
  std::vector<uint32_t> next(tables.first_cell.begin(), tables.first_cell.end() - 1);
  for (const uint32_t i : order) {
    const Patch& patch = cut.patches[i];
    const shader::PatchCell cell{{patch.cell[0], patch.cell[1], patch.cell[2]},
                                 static_cast<uint32_t>(patch.level) << 24 | region[i]};
    const auto add = [&](uint32_t face) {
      tables.patch_of_cell[next[face]] = i;
      tables.patch_cells[next[face]++] = cell;
    };
    for (const uint32_t face : patch.faces) add(face);
    if (patch.is_sky()) add(dome_face(scene, patch.sky));
  }
}

}  // namespace

LineTables make_line_tables(const Scene& scene, const CutFile& cut, const std::string& cut_name) {
  LineTables tables;
  add_cells(scene, cut, cut_name, tables);
  add_surfaces(scene, cut, tables);
  add_pairs(cut, tables);
  tables.light = cut.light;
  if (scene.dome < scene.triangles.size()) tables.first_sky_face = 2 * scene.dome;
  tables.face_normals.resize(scene.triangles.size());
  tbb::parallel_for(uint32_t{0}, static_cast<uint32_t>(scene.triangles.size()), [&](uint32_t t) {
    tables.face_normals[t] = {Vec3f(shape_of(scene, t).normal), 0};
  });
  tables.cell_corner = Vec3f(scene.frame.to_canonical(cut.grid.origin));
  tables.cells_per_unit = static_cast<float>(1 / (cut.grid.base_cell * scene.frame.scale));
  return tables;
}

}  // namespace tdpt
