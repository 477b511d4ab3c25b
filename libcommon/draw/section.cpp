#include "libcommon/draw/section.h"

#include <algorithm>
#include <cmath>

namespace tdpt::draw {

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

std::optional<size_t> CellGrid::cell_at(const Vec3d& place) const {
  const double i = std::floor((place.x - low_x) / cell), j = std::floor((place.z - low_z) / cell);
  if (!(i >= 0 && i < columns && j >= 0 && j < rows)) return {};
  return static_cast<size_t>(i) + static_cast<size_t>(columns) * static_cast<size_t>(j);
}

namespace {

enum class Cell : uint8_t { unknown, line, air };

void mark_line(std::vector<Cell>& cells, const CellGrid& grid, const Segment& s) {
  const Vec3d d = s.b - s.a;
  const int steps =
      1 + static_cast<int>(std::min(2 * std::max(std::abs(d.x), std::abs(d.z)) / grid.cell, 1e5));
  for (int k = 0; k <= steps; ++k)
    if (const auto at = grid.cell_at(s.a + d * (static_cast<double>(k) / steps)))
      cells[*at] = Cell::line;
}

// Marks all that can be reached from a cell.
void mark_air(std::vector<Cell>& cells, const CellGrid& grid, size_t from) {
  const auto columns = static_cast<size_t>(grid.columns);
  std::vector<size_t> open{from};
  while (!open.empty()) {
    const size_t at = open.back();
    open.pop_back();
    if (cells[at] != Cell::unknown) continue;
    cells[at] = Cell::air;
    if (at % columns > 0) open.push_back(at - 1);
    if (at % columns + 1 < columns) open.push_back(at + 1);
    if (at >= columns) open.push_back(at - columns);
    if (at + columns < cells.size()) open.push_back(at + columns);
  }
}

}  // namespace

std::vector<bool> walls(const Scene& scene, const std::vector<Segment>& section,
                        const CellGrid& grid, const std::vector<Vec3d>& air, double thickest) {
  const auto columns = static_cast<size_t>(grid.columns), rows = static_cast<size_t>(grid.rows);
  std::vector<Cell> cells(columns * rows, Cell::unknown);
  for (const Segment& s : section)
    if (!is_pane(scene, s.triangle)) mark_line(cells, grid, s);
  for (const Vec3d& place : air)
    if (const auto at = grid.cell_at(place)) mark_air(cells, grid, *at);
  std::vector<bool> result(cells.size());
  const auto mark_thin = [&](size_t lines, size_t cells_of_line, size_t line_step, size_t step) {
    for (size_t line = 0; line < lines; ++line)
      for (size_t i = 0, end; i < cells_of_line; i = end) {
        const auto cell = [&](size_t k) { return line * line_step + k * step; };
        for (end = i + 1; end < cells_of_line && cells[cell(end)] == cells[cell(i)];) ++end;
        if (cells[cell(i)] != Cell::unknown || i == 0 || end == cells_of_line) continue;
        for (size_t k = i; k < end && static_cast<double>(end - i) * grid.cell <= thickest; ++k)
          result[cell(k)] = true;
      }
  };
  mark_thin(rows, columns, columns, 1);
  mark_thin(columns, rows, 1, columns);
  return result;
}

}  // namespace tdpt::draw
