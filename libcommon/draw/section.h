// A horizontal section of a scene: the lines in which a plane cuts its triangles, and what is solid
// between them, as an architect fills the walls of a plan.
//
// Solid is found by counting: a straight line within the plane, from far outside, enters and leaves
// bodies; the count at a place differs from the count in the air by the bodies around it. It is
// counted from four sides, since an open sheet spoils the count behind it, and the sides vote. The
// count of air is the one at places known to be air, so normals may as well all point inwards, as
// in a room modelled without its walls' outer sides.
#pragma once
#include <cstdint>
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
};
/// `wall`: a body as thin as a wall; `earth`: a thicker one, such as the ground around a cellar.
enum class Filled : uint8_t { air, wall, earth };
/// What fills each cell, at [i + columns * j]. `air`: places known to be in the air; where they
/// contradict each other nothing is filled. `thickest`: of a wall.
std::vector<Filled> filled(const Scene& scene, const std::vector<Segment>& section,
                           const CellGrid& grid, const std::vector<Vec3d>& air, double thickest);

}  // namespace tdpt::draw
