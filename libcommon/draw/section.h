// A horizontal section of a scene: the lines in which a plane cuts its triangles, and the walls
// between them, which an architect fills in a plan.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "libcommon/scene/scene.h"

namespace tdpt::draw {

/// Where the plane cuts a triangle, metres.
struct Segment {
  Vec3d a, b;
  uint32_t triangle;
};
/// The intersection of a scene's triangles with the horizontal plane y = height [m], but for
/// the sky's.
std::vector<Segment> section(const Scene& scene, double height);

/// Whether the triangle's material lets light pass straight through, as a window pane does.
bool is_pane(const Scene& scene, uint32_t triangle);

/// Cells of a rectangle in the plane; metres. Cell (i, j) spans low + cell * [i, i+1) x [j,
/// j+1), in x and z.
struct CellGrid {
  double low_x = 0, low_z = 0, cell = 1;
  int columns = 0, rows = 0;

  /// i + columns * j of the cell that contains a place, or empty outside.
  std::optional<size_t> cell_at(const Vec3d& place) const;
};
/// Whether a cell, at [i + columns * j], lies within a wall: no way leads there from the places
/// known to be in the `air` without a crossing of the section (panes are none), and it is at most
/// `thickest` wide between lines of the section, along x or z. What is wider may be a room that
/// nobody has entered, or the ground around a cellar.
std::vector<bool> walls(const Scene& scene, const std::vector<Segment>& section,
                        const CellGrid& grid, const std::vector<Vec3d>& air, double thickest);

}  // namespace tdpt::draw
