#include "libcommon/draw/section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace tdpt::draw {
namespace {

constexpr double kAgree = 0.6;  // share of the places in the air that have the same count

// Counts of bodies along one axis: `across` is the axis along which lines run.
class Counts {
 public:
  Counts(const CellGrid& grid, bool along_x)
      : along_x_(along_x),
        length_(along_x ? grid.columns : grid.rows),
        count_(static_cast<size_t>(along_x ? grid.rows : grid.columns) *
               static_cast<size_t>(length_ + 1)) {}

  // `a`, `b` in cells, along and across; `enters`: going up the axis, a body begins here.
  void add(double a_along, double a_across, double b_along, double b_across, bool enters) {
    const double low = std::min(a_across, b_across), high = std::max(a_across, b_across);
    const int lines = static_cast<int>(count_.size()) / (length_ + 1);
    const int from = std::max(0, static_cast<int>(std::ceil(std::max(low, -1.0) - 0.5)));
    for (int line = from; line < lines && line + 0.5 < high; ++line) {
      if ((a_across <= line + 0.5) == (b_across <= line + 0.5)) continue;
      const double t = (line + 0.5 - a_across) / (b_across - a_across);
      const double at = a_along + t * (b_along - a_along);
      // The first cell whose middle lies beyond.
      const int cell = static_cast<int>(std::clamp(std::ceil(at - 0.5), 0.0, length_ + 0.0));
      count_[index(line, cell)] += enters ? 1 : -1;
    }
  }
  void sum_up() {
    for (size_t i = 1; i < count_.size(); ++i)
      if (i % static_cast<size_t>(length_ + 1) != 0) count_[i] += count_[i - 1];
  }
  // Bodies around cell (i, j), counted from the low end or from the high end of the axis.
  int at(int i, int j, bool from_high) const {
    const int line = along_x_ ? j : i, cell = along_x_ ? i : j;
    return count_[index(line, cell)] - (from_high ? count_[index(line, length_)] : 0);
  }

 private:
  size_t index(int line, int cell) const {
    return static_cast<size_t>(line) * static_cast<size_t>(length_ + 1) + static_cast<size_t>(cell);
  }
  bool along_x_;
  int length_;
  std::vector<int> count_;
};

size_t at(const CellGrid& grid, int i, int j) {
  return static_cast<size_t>(i) + static_cast<size_t>(grid.columns) * static_cast<size_t>(j);
}

// Cells that a line passes.
void mark(std::vector<uint8_t>& cells, const CellGrid& grid, const Segment& s) {
  const Vec3d d = s.b - s.a;
  const int steps =
      1 + static_cast<int>(std::min(2 * std::max(std::abs(d.x), std::abs(d.z)) / grid.cell, 1e5));
  for (int k = 0; k <= steps; ++k) {
    const Vec3d p = s.a + d * (static_cast<double>(k) / steps);
    const double i = std::floor((p.x - grid.low_x) / grid.cell),
                 j = std::floor((p.z - grid.low_z) / grid.cell);
    if (i >= 0 && i < grid.columns && j >= 0 && j < grid.rows)
      cells[at(grid, static_cast<int>(i), static_cast<int>(j))] = 1;
  }
}

// Marks as earth what is thicker than a wall both ways, and as air what is thick and `outside` of
// everything. Bodies that touch are parted by their outlines.
void part_earth(std::vector<Filled>& cells, const std::vector<uint8_t>& outline,
                const std::vector<uint8_t>& outside, const CellGrid& grid, double thickest) {
  std::vector<uint8_t> thick_ways(cells.size());
  const auto measure = [&](int lines, int cells_of_line, size_t line_step, size_t step) {
    for (int line = 0; line < lines; ++line)
      for (int i = 0, end; i < cells_of_line; i = end) {
        const auto cell = [&](int k) {
          return static_cast<size_t>(line) * line_step + static_cast<size_t>(k) * step;
        };
        const auto is_inside = [&](int k) {
          return cells[cell(k)] != Filled::air && !outline[cell(k)];
        };
        for (end = i + 1; end < cells_of_line && is_inside(i) && is_inside(end);) ++end;
        // What goes on beyond the grid is thick.
        if ((end - i) * grid.cell > thickest || i == 0 || end == cells_of_line)
          for (int k = i; k < end; ++k) ++thick_ways[cell(k)];
      }
  };
  const auto columns = static_cast<size_t>(grid.columns);
  measure(grid.rows, grid.columns, columns, 1);
  measure(grid.columns, grid.rows, 1, columns);
  for (size_t k = 0; k < cells.size(); ++k)
    if (thick_ways[k] == 2) cells[k] = outside[k] ? Filled::air : Filled::earth;
  // Outlines within the earth are its seams.
  for (size_t k = columns; k + columns < cells.size(); ++k)
    if (outline[k] && cells[k] == Filled::wall &&
        ((cells[k - 1] == Filled::earth && cells[k + 1] == Filled::earth) ||
         (cells[k - columns] == Filled::earth && cells[k + columns] == Filled::earth)))
      cells[k] = Filled::earth;
}

}  // namespace

std::vector<Segment> section(const Scene& scene, double height) {
  std::vector<Segment> found;
  const auto end = std::min<size_t>(scene.triangles.size(), scene.dome);
  for (uint32_t i = 0; i < end; ++i) {
    Vec3d cut[3], p[3];
    for (int k = 0; k < 3; ++k) p[k] = scene.frame.to_metres(Vec3d(scene.vertex(i, k)));
    int n = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3d &a = p[k], &b = p[(k + 1) % 3];
      if ((a.y < height) != (b.y < height)) cut[n++] = a + (b - a) * ((height - a.y) / (b.y - a.y));
    }
    if (n == 2) found.push_back({cut[0], cut[1], i});
  }
  return found;
}

bool is_pane(const Scene& scene, uint32_t triangle) {
  const Material& m = scene.material_of(triangle);
  return m.transmission > 0 || (m.alpha_mode == Material::Alpha::blend && m.alpha < 0.9f);
}

std::vector<Filled> filled(const Scene& scene, const std::vector<Segment>& section,
                           const CellGrid& grid, const std::vector<Vec3d>& air, double thickest) {
  Counts along_x(grid, true), along_z(grid, false);
  std::vector<uint8_t> outline(static_cast<size_t>(grid.columns) * static_cast<size_t>(grid.rows));
  std::vector<Filled> cells(outline.size(), Filled::air);
  for (const Segment& s : section) {
    if (is_pane(scene, s.triangle)) continue;
    const Vec3d n = shape_of(scene, s.triangle).normal;
    const double ax = (s.a.x - grid.low_x) / grid.cell, az = (s.a.z - grid.low_z) / grid.cell,
                 bx = (s.b.x - grid.low_x) / grid.cell, bz = (s.b.z - grid.low_z) / grid.cell;
    along_x.add(ax, az, bx, bz, n.x < 0);
    along_z.add(az, ax, bz, bx, n.z < 0);
    mark(outline, grid, s);
  }
  along_x.sum_up();
  along_z.sum_up();
  const auto count = [&](int side, int i, int j) {
    return (side < 2 ? along_x : along_z).at(i, j, side % 2 == 1);
  };
  std::array<int, 4> of_air{};
  std::vector<int> trusted;
  for (int side = 0; side < 4; ++side) {
    std::map<int, size_t> times;
    size_t all = 0;
    for (const Vec3d& p : air) {
      const double i = std::floor((p.x - grid.low_x) / grid.cell),
                   j = std::floor((p.z - grid.low_z) / grid.cell);
      if (!(i >= 0 && i < grid.columns && j >= 0 && j < grid.rows)) continue;
      ++times[count(side, static_cast<int>(i), static_cast<int>(j))];
      ++all;
    }
    const auto most =
        std::max_element(times.begin(), times.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (all == 0 || static_cast<double>(most->second) < kAgree * static_cast<double>(all)) continue;
    of_air[static_cast<size_t>(side)] = most->first;
    trusted.push_back(side);
  }
  if (trusted.size() < 2) return cells;
  std::vector<uint8_t> outside(cells.size());
  for (int j = 0; j < grid.rows; ++j)
    for (int i = 0; i < grid.columns; ++i) {
      size_t solid = 0, bodies = 0;  // sides that count other than in the air, and any at all
      for (const int side : trusted) {
        const int n = count(side, i, j);
        solid += n != of_air[static_cast<size_t>(side)];
        bodies += n != 0;
      }
      const auto most = [&](size_t votes) {
        return votes + 1 >= trusted.size() && 2 * votes > trusted.size();
      };
      outside[at(grid, i, j)] = !most(bodies);
      if (most(solid)) cells[at(grid, i, j)] = Filled::wall;
    }
  part_earth(cells, outline, outside, grid, thickest);
  return cells;
}

}  // namespace tdpt::draw
